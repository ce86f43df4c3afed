#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "model/config/chip_parameters.hpp"
#include "model/config/chip_presets.hpp"
#include "tests/support/chip_config_support.hpp"

namespace model {
namespace chip_config_test {

std::string set_error(std::string_view key, std::string_view text) {
  return error_of([&] {
    ChipConfig config = default_chip_config();
    set_parameter(config, key, text, "--set");
  });
}

/// Values just outside what is allowed, as text.
std::vector<std::string> refused_texts(const ParameterInfo& parameter) {
  const double infinity = std::numeric_limits<double>::infinity();
  if (const auto* integers = std::get_if<IntegerRange>(&parameter.allowed)) {
    std::vector<std::string> texts = {std::to_string(integers->low - 1),
                                      std::to_string(integers->high + 1),
                                      std::to_string(integers->low - integers->multiple_of),
                                      std::to_string(integers->high + integers->multiple_of),
                                      "1.5",
                                      "99999999999999999999"};
    if (integers->multiple_of > 1) texts.push_back(std::to_string(integers->low + 1));
    return texts;
  }
  if (const auto* reals = std::get_if<RealRange>(&parameter.allowed)) {
    return {value_text(std::nextafter(reals->low, -infinity)),
            value_text(std::nextafter(reals->high, infinity)),
            "nan",
            "inf",
            "-1",
            "1e999"};
  }
  if (std::holds_alternative<Choice>(parameter.allowed)) return {"fifo", "STRICT_FIFO", "0"};
  return {"1", "yes", "True"};
}

TEST(ParameterTable, EveryParameterIsDescribed) {
  std::set<std::string> ids;
  for (const ParameterSource& source : parameter_sources()) ids.insert(std::string(source.id));
  for (const ParameterInfo& parameter : parameter_table()) {
    SCOPED_TRACE(parameter.key);
    EXPECT_FALSE(parameter.unit.empty());
    EXPECT_GE(parameter.meaning.size(), 10U);
    EXPECT_EQ(parameter.meaning.find('\n'), std::string::npos);
    const auto name = confidence_name(parameter.confidence);
    EXPECT_NE(std::find(kConfidenceNames.begin(), kConfidenceNames.end(), name), kConfidenceNames.end());
    // A value that is not assumed names its source, or (16-bit passes) the arithmetic it follows from.
    if (parameter.confidence != Confidence::assumed && parameter.key.find("_alu") == std::string::npos) {
      EXPECT_NE(parameter.meaning.find('['), std::string::npos) << parameter.meaning;
    }
  }
}

/// The ids of a text's "[S5, S7]" and "[reference, section 9]".
std::set<std::string> cited_ids(const std::string& text) {
  std::set<std::string> ids;
  for (std::size_t open = text.find('['); open != std::string::npos; open = text.find('[', open + 1)) {
    std::istringstream cited(text.substr(open + 1, text.find(']', open) - open - 1));
    for (std::string id; std::getline(cited >> std::ws, id, ',');) {
      if (id.rfind("section", 0) != 0) ids.insert(id);
    }
  }
  return ids;
}

TEST(ParameterTable, EveryCitedSourceIsListedAndEveryListedOneIsCited) {
  std::set<std::string> cited;
  for (const ParameterInfo& parameter : parameter_table()) cited.merge(cited_ids(parameter.meaning));
  for (const Preset& preset : preset_table()) {
    for (const PresetOverride& set : preset.overrides) cited.merge(cited_ids(std::string(set.why)));
  }
  std::set<std::string> listed;
  for (const ParameterSource& source : parameter_sources()) listed.insert(std::string(source.id));
  EXPECT_EQ(cited, listed);
}

TEST(ParameterTable, KeysAreUniqueAndGroupsStayTogether) {
  std::set<std::string> keys;
  std::set<std::string> groups;
  std::string last_group;
  for (const ParameterInfo& parameter : parameter_table()) {
    EXPECT_TRUE(keys.insert(parameter.key).second) << parameter.key;
    const std::string group = parameter.key.substr(0, parameter.key.rfind('.'));
    if (group != last_group) {
      EXPECT_TRUE(groups.insert(group).second) << group;
    }
    last_group = group;
    EXPECT_EQ(find_parameter(parameter.key), &parameter);
  }
}

/// Converts to any type: counts the fields of an aggregate by how many of it initialise one.
struct Anything {
  template <class T>
  operator T() const;
};
template <class Aggregate, class... Fields>
constexpr auto initialises(int) -> decltype(Aggregate{Fields{}...}, true) {
  return true;
}
template <class, class...>
constexpr bool initialises(long) {
  return false;
}
template <class Aggregate, class... Fields>
constexpr std::size_t field_count() {
  if constexpr (initialises<Aggregate, Fields..., Anything>(0)) {
    return field_count<Aggregate, Fields..., Anything>();
  } else {
    return sizeof...(Fields);
  }
}

std::size_t keys_of(const std::string& group) {
  const auto in_group = [&](const ParameterInfo& parameter) {
    return parameter.key.rfind(group + ".", 0) == 0;
  };
  return std::size_t(std::count_if(parameter_table().begin(), parameter_table().end(), in_group));
}

// With ChangingAKeyChangesThatLineOnly below: as many keys as fields, each with a field of its own.
TEST(ParameterTable, CoversEveryField) {
  const ChipConfig config = default_chip_config();
  const auto& [preset, chip, poly, control, pio, clear_connect, ddr, on_chip_sram, search_unit, board, host,
               technology, energy, area] = config;  // a new group breaks this line
  EXPECT_EQ(preset, "csx600");
  EXPECT_EQ(keys_of("chip"), field_count<std::decay_t<decltype(chip)>>());
  EXPECT_EQ(keys_of("poly"), field_count<std::decay_t<decltype(poly)>>() - 1 + cn::kInstructionClasses);
  EXPECT_EQ(keys_of("poly.cycles"), cn::kInstructionClasses);
  EXPECT_EQ(keys_of("control"), field_count<std::decay_t<decltype(control)>>());
  EXPECT_EQ(keys_of("pio"), field_count<std::decay_t<decltype(pio)>>());
  EXPECT_EQ(keys_of("clear_connect"), field_count<std::decay_t<decltype(clear_connect)>>());
  EXPECT_EQ(keys_of("ddr"), field_count<std::decay_t<decltype(ddr)>>());
  EXPECT_EQ(keys_of("on_chip_sram"), field_count<std::decay_t<decltype(on_chip_sram)>>());
  EXPECT_EQ(keys_of("search_unit"), field_count<std::decay_t<decltype(search_unit)>>());
  EXPECT_EQ(keys_of("technology"), field_count<std::decay_t<decltype(technology)>>());
  EXPECT_EQ(keys_of("area"), field_count<std::decay_t<decltype(area)>>());
  EXPECT_EQ(keys_of("board"), field_count<std::decay_t<decltype(board)>>());
  EXPECT_EQ(keys_of("host"), field_count<std::decay_t<decltype(host)>>());
  EXPECT_EQ(keys_of("energy.picojoules"), cn::kInstructionClasses - 1) << "mono has no energy of its own";
  EXPECT_EQ(keys_of("energy"),
            field_count<std::decay_t<decltype(energy)>>() - 1 + keys_of("energy.picojoules"));
  EXPECT_EQ(field_count<ChipConfig::Chip>(), 4U);
  EXPECT_EQ(field_count<ChipConfig::Pio>(), 9U);
}

TEST(ParameterTable, ABoardHasOneTwoOrFourChips) {
  ChipConfig config = default_chip_config();
  for (const int chips : {1, 2, 4}) {
    set_parameter(config, "board.chips", std::to_string(chips), "--set");
    EXPECT_EQ(config.board.chips, chips);
  }
  for (const char* chips : {"0", "3", "5", "-2", "8"})
    EXPECT_EQ(set_error("board.chips", chips),
              "--set: board.chips: found '" + std::string(chips) + "'; allowed: a power of two from 1 to 4");
}

TEST(ParameterTable, InstructionClassesKeepTheirNamesAndPlaces) {
  ChipConfig config = default_chip_config();
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i) {
    const std::string key = "poly.cycles." + std::string(cn::kInstructionClassNames[i]);
    set_parameter(config, key, std::to_string(1000 + i), "--set");
    EXPECT_EQ(config.poly.cycles[i], 1000.0 + double(i)) << key;
  }
}

// Figures of the reference, sections 1, 2, 3 and 9, not read from the table.
TEST(ParameterTable, DefaultsAreTheReferences) {
  using cn::InstructionClass;
  const ChipConfig config = default_chip_config();
  const auto cycles = [&](InstructionClass c) { return config.poly.cycles[std::size_t(c)]; };
  EXPECT_EQ(config.chip.clock_hz, 210e6);
  EXPECT_EQ(config.chip.pes, 96);
  EXPECT_EQ(config.poly.sram_bytes, 6 * 1024);
  EXPECT_EQ(config.poly.code_quality_factor, 1.0);
  EXPECT_EQ(cycles(InstructionClass::fp64_add), 4);
  EXPECT_EQ(cycles(InstructionClass::fp64_mul), 4);
  EXPECT_EQ(cycles(InstructionClass::fp64_div), 40);
  EXPECT_EQ(cycles(InstructionClass::fp64_sqrt), 50);
  EXPECT_EQ(cycles(InstructionClass::fp64_sincos), 110);
  EXPECT_EQ(cycles(InstructionClass::fp64_exp), 90);
  EXPECT_EQ(cycles(InstructionClass::fp64_log), 90);
  EXPECT_EQ(cycles(InstructionClass::fp64_atan2), 110);
  EXPECT_EQ(cycles(InstructionClass::fp32_div), 24);
  EXPECT_EQ(cycles(InstructionClass::fp32_sqrt), 28);
  // Four elements, one a cycle; multiplier and adder at once: 96 x 2 x f is the peak.
  EXPECT_EQ(cycles(InstructionClass::fp64_add_vector4), 4);
  EXPECT_EQ(cycles(InstructionClass::fp64_mul_vector4), 4);
  EXPECT_EQ(96 * 8 / cycles(InstructionClass::fp64_multiply_add_vector4) * 250e6, 48e9);
  EXPECT_EQ(cycles(InstructionClass::fp32_add_vector4), 4);
  EXPECT_EQ(cycles(InstructionClass::fp32_mul_vector4), 4);
  EXPECT_EQ(cycles(InstructionClass::fp32_multiply_add_vector4), 4);
  EXPECT_EQ(cycles(InstructionClass::sram_vector_load), cycles(InstructionClass::sram));
  EXPECT_EQ(cycles(InstructionClass::swazzle_vector4), 4 * 8 / 8);  // 8 bytes a PE and cycle
  EXPECT_TRUE(config.poly.vector_loads_overlap);
  EXPECT_EQ(cycles(InstructionClass::int32_alu), 2);
  EXPECT_EQ(cycles(InstructionClass::int32_mul), 6);
  EXPECT_EQ(cycles(InstructionClass::enable), 1);
  EXPECT_EQ(cycles(InstructionClass::sram), 96e9 / (96 * 250e6 * 4));
  EXPECT_EQ(cycles(InstructionClass::swazzle), 2);
  EXPECT_EQ(config.control.data_cache_bytes, 4096);
  EXPECT_EQ(config.control.cache_miss_cycles, 25);
  EXPECT_EQ(config.pio.arbitration, PioArbitration::reads_overtake_writes);
  EXPECT_FALSE(config.pio.consolidate_equal_addresses);
  EXPECT_EQ(config.ddr.size_bytes, 536870912U);
  EXPECT_EQ(config.ddr.page_hit_cycles, 40);
  EXPECT_EQ(config.ddr.page_miss_cycles, 60);
  EXPECT_EQ(config.ddr.refresh_interval_cycles, int(7.8e-6 * 210e6));
  EXPECT_EQ(config.ddr.refresh_cycles, int(std::ceil(105e-9 * 210e6)));
  EXPECT_EQ(config.host.bytes_per_second, 800e6);
  EXPECT_EQ(config.host.latency_cycles, 2100);
  // 80 bytes for each of 96 PEs: 2,646 cycles (reference, section 2).
  const int request =
      config.pio.setup_cycles + 96 * (config.pio.per_pe_cycles + 80 / config.pio.bytes_per_cycle);
  EXPECT_EQ(request, 2646);
}

TEST(SetParameter, EveryKeyIsSetAndReadBack) {
  for (const ParameterInfo& parameter : parameter_table()) {
    for (const ParameterValue& value : other_values(parameter)) {
      SCOPED_TRACE(parameter.key + " = " + value_text(value));
      ChipConfig by_text = default_chip_config();
      set_parameter(by_text, parameter.key, value_text(value), "--set");
      EXPECT_EQ(parameter.read(by_text), value);
      EXPECT_EQ(parameter_text(by_text, parameter.key), value_text(value));
      EXPECT_EQ(differences(by_text, default_chip_config()), std::vector<std::string>{parameter.key});

      ChipConfig by_value = default_chip_config();
      set_parameter_value(by_value, parameter.key, value, "--set");
      EXPECT_TRUE(differences(by_value, by_text).empty());
    }
    EXPECT_FALSE(other_values(parameter).empty()) << parameter.key;
  }
}

TEST(SetParameter, RefusesWhatIsJustOutOfRangeAndChangesNothing) {
  for (const ParameterInfo& parameter : parameter_table()) {
    std::vector<std::string> texts = refused_texts(parameter);
    for (const char* text : {"", " ", "96 ", " 96", "0x10", "12abc", "++1", "true1"}) texts.push_back(text);
    for (const std::string& text : texts) {
      SCOPED_TRACE(parameter.key + " = " + text);
      ChipConfig config = default_chip_config();
      const std::string message = error_of([&] { set_parameter(config, parameter.key, text, "--set"); });
      EXPECT_EQ(message,
                "--set: " + parameter.key + ": found '" + text + "'; allowed: " + allowed_text(parameter));
      EXPECT_TRUE(differences(config, default_chip_config()).empty());
    }
  }
}

TEST(SetParameter, MessagesNameOriginKeyFoundAndAllowed) {
  EXPECT_EQ(set_error("chip.pes", "100"),
            "--set: chip.pes: found '100'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(set_error("chip.clock_hz", "fast"),
            "--set: chip.clock_hz: found 'fast'; allowed: a number from 1000000 to 10000000000");
  EXPECT_EQ(set_error("pio.arbitration", "fifo"),
            "--set: pio.arbitration: found 'fifo'; allowed: one of strict_fifo, reads_overtake_writes, "
            "queue_per_direction");
  EXPECT_EQ(set_error("pio.consolidate_equal_addresses", "1"),
            "--set: pio.consolidate_equal_addresses: found '1'; allowed: true or false");
  EXPECT_EQ(error_of([] {
              ChipConfig config = default_chip_config();
              set_parameter_value(config, "pio.setup_cycles", std::string("150"), "chip.toml:7");
            }),
            "chip.toml:7: pio.setup_cycles: found 'string 150'; allowed: an integer from 0 to 1000000");
}

TEST(SetParameter, UnknownKeySuggestsTheNearest) {
  EXPECT_EQ(set_error("pio.setup_cycle", "1"),
            "--set: unknown parameter 'pio.setup_cycle'; nearest known: 'pio.setup_cycles'; allowed: the "
            "keys listed by "
            "'csx600 params'");
  const std::vector<std::pair<std::string, std::string>> nearest = {
      {"setup_cycles", "pio.setup_cycles"},
      {"chip.pe", "chip.pes"},
      {"poly.cycles.fp64_ad", "poly.cycles.fp64_add"},
      {"ddr.page_byte", "ddr.page_bytes"},
      {"DDR.banks", "ddr.banks"}};
  for (const auto& [typed, known] : nearest) {
    EXPECT_NE(set_error(typed, "1").find("nearest known: '" + known + "'"), std::string::npos)
        << set_error(typed, "1");
  }
  EXPECT_EQ(set_error("", "1").rfind("--set: unknown parameter ''", 0), 0U);
  EXPECT_NE(error_of([] { parameter_text(default_chip_config(), "chip.watts"); }).find("chip.watts"),
            std::string::npos);
}

TEST(SetParameter, RealsAreReadAndWrittenExactly) {
  ChipConfig config = default_chip_config();
  for (const double value : {0.1, 1.0 / 3.0, 4.000000000000001, 1e-300, 12345.678901234567, 5e-324}) {
    set_parameter(config, "poly.cycles.convert", value_text(value), "--set");
    EXPECT_EQ(config.poly.cycles[std::size_t(cn::InstructionClass::convert)], value);
  }
  EXPECT_EQ(parameter_text(config, "chip.clock_hz"), "210000000");
  EXPECT_EQ(value_text(0.1), "0.1");
  EXPECT_EQ(value_text(1e22), "1e+22");
  set_parameter(config, "poly.cycles.move", "-0", "--set");
  EXPECT_EQ(parameter_text(config, "poly.cycles.move"), "0");
}

std::string validate_error(const std::vector<std::pair<std::string, std::string>>& settings) {
  ChipConfig config = default_chip_config();
  for (const auto& [key, text] : settings) set_parameter(config, key, text, "--set");
  return error_of([&] { validate(config); });
}

TEST(Validate, ChecksWhatMustHoldBetweenParameters) {
  EXPECT_EQ(validate_error({{"control.data_cache_bytes", "4104"}}),
            "control.data_cache_bytes: found '4104'; allowed: a multiple of control.cache_line_bytes (32)");
  EXPECT_EQ(validate_error({{"clear_connect.bytes_per_cycle", "65"}}),
            "clear_connect.packet_bytes: found '64'; allowed: at least clear_connect.bytes_per_cycle (65)");
  EXPECT_EQ(validate_error({{"ddr.page_bytes", "520"}}),
            "ddr.page_bytes: found '520'; allowed: a multiple of control.cache_line_bytes (32)");
  EXPECT_EQ(validate_error({{"clear_connect.packet_bytes", "1024"}}),
            "ddr.page_bytes: found '512'; allowed: a multiple of clear_connect.packet_bytes (1024)");
  EXPECT_EQ(validate_error({{"ddr.page_miss_cycles", "39"}}),
            "ddr.page_miss_cycles: found '39'; allowed: at least ddr.page_hit_cycles (40)");
  EXPECT_EQ(
      validate_error({{"ddr.banks", "3"}}),
      "ddr.size_bytes: found '536870912'; allowed: a multiple of ddr.banks (3) times ddr.page_bytes (512)");
  EXPECT_EQ(validate_error({{"ddr.refresh_cycles", "1638"}}),
            "ddr.refresh_cycles: found '1638'; allowed: less than ddr.refresh_interval_cycles (1638)");
  ChipConfig config = default_chip_config();
  config.ddr.banks = 3;
  EXPECT_EQ(error_of([&] { validate(config, "chip.toml"); }).rfind("chip.toml: ddr.size_bytes: ", 0), 0U);
}

TEST(Validate, AcceptsTheEdgesOfTheseChecks) {
  ChipConfig config = default_chip_config();
  config.clear_connect.bytes_per_cycle = config.clear_connect.packet_bytes;
  config.ddr.page_miss_cycles = config.ddr.page_hit_cycles;
  config.ddr.refresh_cycles = config.ddr.refresh_interval_cycles - 1;
  EXPECT_NO_THROW(validate(config));
  config.ddr.refresh_interval_cycles = 0;  // never
  EXPECT_NO_THROW(validate(config));
}

TEST(Validate, ChecksRangesOfFieldsThatWereSetDirectly) {
  ChipConfig config = default_chip_config();
  config.chip.pes = 97;
  EXPECT_EQ(error_of([&] { validate(config); }),
            "chip.pes: found '97'; allowed: an integer from 8 to 1024, a multiple of 8");
  config = default_chip_config();
  config.chip.clock_hz = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of([&] { validate(config); }).rfind("chip.clock_hz: found 'nan'", 0), 0U);
  config = default_chip_config();
  config.ddr.size_bytes = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(error_of([&] { validate(config); }).rfind("ddr.size_bytes: found '", 0), 0U);
}

}  // namespace chip_config_test
}  // namespace model
