#include "firmware/path_tracer/program/program_options.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

namespace path_tracer {
namespace {

using Options = std::vector<ProgramOption>;

/// A field of ProgramConfig, behind pointers to members that lead to it.
template <auto... path>
struct Field {
  static auto& of(ProgramConfig& config) { return (config.*....*path); }
  static const auto& of(const ProgramConfig& config) { return (config.*....*path); }
  using Type = std::decay_t<decltype(of(std::declval<ProgramConfig&>()))>;

  static OptionValue read_integer(const ProgramConfig& config) { return std::int64_t{of(config)}; }
  static void write_integer(ProgramConfig& config, const OptionValue& value) {
    of(config) = static_cast<int>(std::get<std::int64_t>(value));
  }

  static OptionValue read_as_held(const ProgramConfig& config) { return of(config); }
  static void write_as_held(ProgramConfig& config, const OptionValue& value) {
    of(config) = std::get<Type>(value);
  }

  static OptionValue read_name(const ProgramConfig& config) { return std::string(name_of(of(config))); }
  static void write_name(ProgramConfig& config, const OptionValue& value) {
    std::size_t number = 0;
    while (name_of(Type(number)) != std::get<std::string>(value)) ++number;
    of(config) = Type(number);
  }
};

template <auto... path>
ProgramOption integer(std::string name, std::string unit, std::int64_t default_value, IntegerRange range,
                      std::string meaning) {
  using F = Field<path...>;
  return {std::move(name),    std::move(unit),  default_value,    range,
          std::move(meaning), &F::read_integer, &F::write_integer};
}

template <auto... path>
ProgramOption one_of(std::string name, std::string unit, std::int64_t default_value, IntegerList values,
                     std::string meaning) {
  using F = Field<path...>;
  return {std::move(name),    std::move(unit),  default_value,    std::move(values),
          std::move(meaning), &F::read_integer, &F::write_integer};
}

template <auto... path>
ProgramOption real(std::string name, std::string unit, double default_value, OpenInterval interval,
                   std::string meaning) {
  using F = Field<path...>;
  return {std::move(name),    std::move(unit),  default_value,    interval,
          std::move(meaning), &F::read_as_held, &F::write_as_held};
}

/// The default is a value of the enumeration.
template <auto... path, class NameArray>
ProgramOption choice(std::string name, typename Field<path...>::Type default_value, const NameArray& names,
                     std::string meaning) {
  using F = Field<path...>;
  return {std::move(name),
          "-",
          std::string(name_of(default_value)),
          Names(names.begin(), names.end()),
          std::move(meaning),
          &F::read_name,
          &F::write_name};
}

/// An option that `csx600 render` chooses by scene and chip, unless it is given.
ProgramOption chosen(std::string how, ProgramOption option) {
  option.chosen = std::move(how);
  return option;
}

// Which of the two directions are buffered, as one choice (the rows of the paper's Table 2).
constexpr std::array kBufferNames = {"none", "loads", "saves", "both"};

OptionValue read_buffer(const ProgramConfig& config) {
  return std::string(kBufferNames[std::size_t(config.buffer_loads) + 2 * std::size_t(config.buffer_saves)]);
}
void write_buffer(ProgramConfig& config, const OptionValue& value) {
  const std::string& name = std::get<std::string>(value);
  config.buffer_loads = name == "loads" || name == "both";
  config.buffer_saves = name == "saves" || name == "both";
}

OptionValue read_shadow_rays(const ProgramConfig& config) {
  return std::string(config.cull_shadow_rays ? "facing" : "all");
}
void write_shadow_rays(ProgramConfig& config, const OptionValue& value) {
  config.cull_shadow_rays = std::get<std::string>(value) == "facing";
}

OptionValue read_empty_blocks(const ProgramConfig& config) {
  return std::string(config.skips_empty_blocks ? "skip" : "process");
}
void write_empty_blocks(ProgramConfig& config, const OptionValue& value) {
  config.skips_empty_blocks = std::get<std::string>(value) == "skip";
}

OptionValue read_constant_textures(const ProgramConfig& config) {
  return std::string(config.folds_constant_textures ? "factor" : "look_up");
}
void write_constant_textures(ProgramConfig& config, const OptionValue& value) {
  config.folds_constant_textures = std::get<std::string>(value) == "factor";
}

Names built_for_names() {
  Names names;
  for (const ExtraFeature& feature : kBuiltForTable) names.emplace_back(feature.name);
  return names;
}
OptionValue read_built_for(const ProgramConfig& config) {
  return std::string(kBuiltForTable.at(std::size_t(config.built_for)).name);
}
void write_built_for(ProgramConfig& config, const OptionValue& value) {
  const Names names = built_for_names();
  const auto found = std::find(names.begin(), names.end(), std::get<std::string>(value));
  config.built_for = static_cast<int>(found - names.begin());
}

// Ranges end where slot numbers would overflow or more makes no sense, not where a chip's SRAM ends.
constexpr std::int64_t kMaxSegments = 1 << 30;
constexpr std::int64_t kMaxStride = 1 << 30;

ProgramOption resident_paths() {
  return one_of<&ProgramConfig::resident_paths>(
      "resident_paths", "paths", 0, {0, 1, kMaxResidentPaths},
      "paths that each PE keeps in its SRAM beside the whole scene, instead of bins in mono memory (0); 4 "
      "share vector instructions. For plain scenes that fit");
}

Options bins() {
  return {choice<&ProgramConfig::program>(
              "program", Program::full, kProgramNames,
              "what is timed: path segments; with a shadow ray each; with the radiance of finished paths"),
          choice<&ProgramConfig::execution>(
              "execution", Execution::mtap, kExecutionNames,
              "mtap: PEs keep data between kernels and number each other; stream: as on a stream processor, "
              "each kernel reads from mono memory and writes all results back"),
          integer<&ProgramConfig::n>("n", "blocks", 1, {0, kMaxBuffers},
                                     "blocks loaded ahead and saved behind; 0: none"),
          {"buffer", "-", std::string("both"), Names(kBufferNames.begin(), kBufferNames.end()),
           "what is n-buffered", &read_buffer, &write_buffer},
          integer<&ProgramConfig::bin_blocks>("bin_blocks", "blocks", 8, {1, kMaxBinBlocks},
                                              "length of each bin in blocks of one SIMD width"),
          integer<&ProgramConfig::slot_vertices>(
              "slot_vertices", "vertices", 16, {kVerticesPerLoad, kMaxSlotVertices, kVerticesPerLoad},
              "vertices that a path slot holds; a longer path is folded into its radiance so far"),
          {"shadow_rays", "-", std::string("facing"), Names{"all", "facing"},
           "which shadow rays are cast: all, or those between a surface and a light that face each other",
           &read_shadow_rays, &write_shadow_rays},
          {"empty_blocks", "-", std::string("skip"), Names{"skip", "process"},
           "blocks of slots without a path: left out, or processed like the others", &read_empty_blocks,
           &write_empty_blocks},
          {"constant_textures", "-", std::string("factor"), Names{"factor", "look_up"},
           "textures whose texels are all equal: factors of their materials, or looked up like others",
           &read_constant_textures, &write_constant_textures},
          {"built_for", "-", std::string(kBuiltForTable[kBuiltForScene].name), built_for_names(),
           "what the firmware is built for: the features of its scene, which pays for nothing else, with one "
           "more, "
           "or anything",
           &read_built_for, &write_built_for},
          choice<&ProgramConfig::shading>(
              "shading", Shading::present_lobes, kShadingNames,
              "hits that are shaded together: blocks of slots, for every lobe or for those present; or bins "
              "of hits, by their material's lobes, or by these and its textures"),
          resident_paths(),
          choice<&ProgramConfig::scratchpad>(
              "scratchpad", Scratchpad::none, kScratchpadNames,
              "arrays of the scene that the firmware copies to the memory on the chip as it starts; fitting: "
              "nodes, triangles, surfaces, lights, each if it fits as a whole"),
          integer<&ProgramConfig::pixel_stride>(
              "pixel_stride", "pixels", 1, {1, kMaxStride},
              "from one camera ray to the next: 1 in order, more to shuffle; the image is the same")};
}

// The defaults give the least error for the time (`csx600 bench error`, Cornell box).
Options sampling() {
  return {
      choice<&ProgramConfig::paths>(
          "paths", Paths::unidirectional, kPathsNames,
          "paths from the lens alone, or from the lens and from a light, whose vertices are joined"),
      integer<&ProgramConfig::light_vertices>(
          "light_vertices", "vertices", 2, {1, kMaxLightVertices},
          "vertices of a light path that a slot of bidirectional paths keeps; it ends there"),
      choice<&ProgramConfig::sampler>(
          "sampler", Sampler::sobol, kSamplerNames,
          "random numbers: philox (independent) or sobol (Owen-scrambled: a pixel's are stratified)"),
      choice<&ProgramConfig::light_sampling>(
          "light_sampling", LightSampling::solid_angle, kLightSamplingNames,
          "points of a light: uniform in its area, or in the solid angle that it subtends"),
      chosen("mis under an environment's image",
             choice<&ProgramConfig::estimator>(
                 "estimator", Estimator::per_lobe, kEstimatorNames,
                 "light of emitting triangles and of an environment's image: by shadow rays, by shadow rays "
                 "and hits weighed against each other, or as suits each surface")),
      chosen("8 where lights are many",
             one_of<&ProgramConfig::light_candidates>(
                 "light_candidates", "lights", 1, {1, 2, 4, kMaxLightCandidates},
                 "lights of which a vertex takes one by its estimated effect there; 1: by chance alone")),
      integer<&ProgramConfig::roulette_start>("roulette_start", "segments", 3, {0, kMaxSegments},
                                              "segments that a path lives without Russian roulette"),
      real<&ProgramConfig::max_survival>("max_survival", "-", 0.999999, {0, 1},
                                         "largest probability with which roulette lets a path go on"),
      {"seed", "-", std::uint64_t{1}, Unsigned64{}, "seed of the random numbers",
       &Field<&ProgramConfig::seed>::read_as_held, &Field<&ProgramConfig::seed>::write_as_held}};
}

Options tree() {
  constexpr auto shape = &ProgramConfig::tree;
  constexpr auto layout = &TreeShape::layout;
  return {
      chosen("what the scene and the chip make fastest",
             choice<&ProgramConfig::traversal>("traversal", Traversal::brute_force, kTraversalNames,
                                               "how rays find triangles")),
      chosen("4 in a large packet, 16 in a ray stream, fewer if they do not fit",
             integer<&ProgramConfig::packet_blocks>("packet_blocks", "blocks", 8, {1, kMaxPacketBlocks},
                                                    "blocks of rays in a large packet or a ray stream")),
      chosen("what the traversal makes fastest",
             choice<shape, layout, &NodeLayout::format>("node_format", NodeFormat::fp32, kNodeFormatNames,
                                                        "boxes of the tree; quantised8 needs 4 or 8 "
                                                        "children a node")),
      chosen("what the scene makes fastest",
             one_of<shape, layout, &NodeLayout::width>("node_width", "children", 4,
                                                       {std::begin(kNodeWidth), std::end(kNodeWidth)},
                                                       "children of a node")),
      integer<shape, &TreeShape::leaf_triangles>("leaf_triangles", "triangles", 2, {1, kMaxLeafTriangles},
                                                 "triangles of a leaf, at most"),
      chosen("8 / node width, fewer if they do not fit",
             integer<shape, &TreeShape::treelet_nodes>("treelet_nodes", "nodes", 2, {1, kMaxTreeletNodes},
                                                       "nodes that a PE loads at a time")),
      chosen("as many as fit",
             integer<shape, &TreeShape::resident_nodes>("resident_nodes", "nodes", 8, {1, kMaxTreeletNodes},
                                                        "nodes around the root that every PE keeps")),
      chosen("8, fewer if they do not fit",
             one_of<shape, &TreeShape::stack_entries>("stack_entries", "entries", 8,
                                                      {0, 1, 2, 4, 8, 16, kMaxStackEntries},
                                                      "entries of a ray's short stack: 0 or a power of two")),
      chosen("2 to 8, by the traversal and the nodes' width and format",
             integer<shape, &TreeShape::visits>("visits", "nodes", 4, {0, kMaxVisits},
                                                "nodes that a ray visits before PEs load again, at most; 0: "
                                                "all that are in SRAM"))};
}

Options declare_options() {
  Options table;
  const std::pair<OptionGroup, Options> groups[] = {
      {OptionGroup::bins, bins()}, {OptionGroup::sampling, sampling()}, {OptionGroup::tree, tree()}};
  for (const auto& [group, options] : groups)
    for (const ProgramOption& option : options) {
      table.push_back(option);
      table.back().group = group;
    }
  return table;
}

/// Calls the handler of the alternative that a variant holds.
template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

template <class Number>
std::optional<OptionValue> parse(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return OptionValue(number);
}

std::string listed(const IntegerList& values) {
  std::string text;
  for (const std::int64_t value : values) text += (text.empty() ? "" : ", ") + std::to_string(value);
  return text;
}
std::string listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

const char* name_of(OptionGroup group) {
  return kOptionGroupNames.at(std::size_t(group));
}

const std::vector<ProgramOption>& program_options() {
  static const Options table = declare_options();
  return table;
}

const ProgramOption* find_option(std::string_view name) {
  for (const ProgramOption& option : program_options())
    if (option.name == name) return &option;
  return nullptr;
}

ProgramConfig default_program() {
  ProgramConfig config;
  for (const ProgramOption& option : program_options()) option.write(config, option.default_value);
  return config;
}

std::string allowed_text(const ProgramOption& option) {
  const Overloaded describe{
      [](const IntegerRange& range) {
        const std::string text =
            "an integer from " + std::to_string(range.low) + " to " + std::to_string(range.high);
        return range.multiple_of == 1 ? text : text + ", a multiple of " + std::to_string(range.multiple_of);
      },
      [](const IntegerList& values) { return "one of " + listed(values); },
      [](const Unsigned64&) {
        return "an integer from 0 to " + std::to_string(std::numeric_limits<std::uint64_t>::max());
      },
      [](const OpenInterval& interval) {
        return "a number above " + value_text(interval.low) + " and below " + value_text(interval.high);
      },
      [](const Names& names) { return "one of " + listed(names); }};
  return std::visit(describe, option.allowed);
}

std::string value_text(const OptionValue& value) {
  const Overloaded write{
      [](std::int64_t number) { return std::to_string(number); },
      [](std::uint64_t number) { return std::to_string(number); },
      [](double number) {
        std::array<char, 32> text;
        return std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr);
      },
      [](const std::string& name) { return name; }};
  return std::visit(write, value);
}

std::string option_text(const ProgramConfig& program, std::string_view name) {
  return value_text(find_option(name)->read(program));
}

bool is_allowed(const ProgramOption& option, const OptionValue& value) {
  if (option.default_value.index() != value.index()) return false;
  const Overloaded check{
      [&](const IntegerRange& range) {
        const std::int64_t number = std::get<std::int64_t>(value);
        return number >= range.low && number <= range.high && number % range.multiple_of == 0;
      },
      [&](const IntegerList& values) {
        return std::find(values.begin(), values.end(), std::get<std::int64_t>(value)) != values.end();
      },
      [](const Unsigned64&) { return true; },
      [&](const OpenInterval& interval) {
        const double number = std::get<double>(value);
        return number > interval.low && number < interval.high;
      },
      [&](const Names& names) {
        return std::find(names.begin(), names.end(), std::get<std::string>(value)) != names.end();
      }};
  return std::visit(check, option.allowed);
}

std::optional<OptionValue> value_of(const ProgramOption& option, std::string_view text) {
  const Overloaded parser{[&](const IntegerRange&) { return parse<std::int64_t>(text); },
                          [&](const IntegerList&) { return parse<std::int64_t>(text); },
                          [&](const Unsigned64&) { return parse<std::uint64_t>(text); },
                          [&](const OpenInterval&) { return parse<double>(text); },
                          [&](const Names&) { return std::optional<OptionValue>(std::string(text)); }};
  std::optional<OptionValue> value = std::visit(parser, option.allowed);
  if (value && !is_allowed(option, *value)) value.reset();
  return value;
}

}  // namespace path_tracer
