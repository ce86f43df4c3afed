#include "testbench/statistics/rank_render.hpp"

#include <algorithm>

#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// A rank's part as it travels: a line of JSON, then the film's bytes.
std::string render_part(const Scene& scene, const RenderRequest& request, const RenderProgress& progress) {
  try {
    const RenderResult result = request.native ? render_natively(scene, request.options, progress)
                                               : render_on_chip(scene, request.options, progress);
    return json_text({{"statistics", render_statistics(request, result)}}) + "\n" + result.film.bytes();
  } catch (const InputError& error) {
    return json_text({{"error", error.what()}, {"input", true}}) + "\n";
  } catch (const std::exception& error) {
    return json_text({{"error", error.what()}, {"input", false}}) + "\n";
  }
}

std::string render_share(Ranks& ranks, const Scene& scene, const RenderRequest& request,
                         const RenderProgress& progress) {
  if (request.options.work.samples == 0) return json_text(Json::object()) + "\n";
  if (!request.in_own_process) return render_part(scene, request, progress);
  const auto stop = [&ranks] { return ranks.stop_requested(); };
  try {
    return run_in_processes({[&] { return render_part(scene, request, progress); }}, 1, {}, 0, stop).front();
  } catch (const Interrupted&) {
    return json_text({{"interrupted", true}}) + "\n";
  }
}

void add_part(const Scene& scene, FilmSums sums, const std::string& message, RankRender& render,
              Json& parts) {
  const std::size_t end = message.find('\n');
  Json json = Json::parse(message.substr(0, end));
  render.is_partial = render.is_partial || json.contains("interrupted");
  if (!json.contains("statistics")) return;
  Json& statistics = json["statistics"];
  render.film.merge(Film::from_bytes(scene.film, film_scale(scene), sums, message.substr(end + 1)));
  render.segments += statistics["segments"].get<std::uint64_t>();
  render.is_partial = render.is_partial || statistics.contains("partial");
  render.cpu_seconds += statistics[kSimulatorSection]["cpu_seconds"].get<double>();
  if (statistics["simulated_seconds"].is_number())
    render.simulated_seconds =
        std::max(render.simulated_seconds.value_or(0), statistics["simulated_seconds"].get<double>());
  parts.push_back(std::move(statistics));
}

/// Throws what the first rank that failed has thrown.
void throw_error(const std::vector<std::string>& messages) {
  for (std::size_t rank = 0; rank < messages.size(); ++rank) {
    const Json json = Json::parse(messages[rank].substr(0, messages[rank].find('\n')));
    if (!json.contains("error")) continue;
    const std::string text =
        (rank == 0 ? "" : "rank " + std::to_string(rank) + ": ") + json["error"].get<std::string>();
    if (json["input"]) throw InputError(text);
    throw RunError(text);
  }
}

}  // namespace

void take_share(RenderOptions& options, int rank, int ranks) {
  const auto before = [ranks](std::size_t all, int r) {
    return static_cast<int>(all * std::size_t(r) / std::size_t(ranks));
  };
  if (options.camera_samples.empty()) {
    path_tracer::Work& work = options.work;
    const auto all = std::size_t(work.samples);
    work.first_sample += before(all, rank);
    work.samples = before(all, rank + 1) - before(all, rank);
    return;
  }
  auto& list = options.camera_samples;
  const std::size_t all = list.size();
  list.erase(list.begin() + before(all, rank + 1), list.end());
  list.erase(list.begin(), list.begin() + before(all, rank));
  if (list.empty()) options.work.samples = 0;
}

std::optional<RankRender> render_on_ranks(Ranks& ranks, const Scene& scene, const RenderRequest& request,
                                          const RenderProgress& progress) {
  RenderRequest share = request;
  take_share(share.options, ranks.rank(), ranks.size());
  const std::string own = render_share(ranks, scene, share, progress);
  if (!ranks.is_first()) {
    ranks.send(0, own);
    return std::nullopt;
  }
  std::vector<std::string> messages(std::size_t(ranks.size()));
  messages[0] = own;
  for (int others = 1; others < ranks.size(); ++others) {
    Ranks::Message message = ranks.receive();
    messages[std::size_t(message.from)] = std::move(message.bytes);
  }
  throw_error(messages);
  const FilmSums sums = request.options.film_sums;
  RankRender render{Film(scene.film, film_scale(scene), sums), 0, 0, std::nullopt, false, {}};
  Json parts = Json::array();
  for (const std::string& message : messages) add_part(scene, sums, message, render, parts);
  render.statistics = {
      {"format", "csx600-rank-statistics-2"},
      {"scene", request.scene},
      {"ranks", ranks.size()},
      {"simulated_seconds", render.simulated_seconds ? Json(*render.simulated_seconds) : Json()},
      {"segments", render.segments},
      {"image_sha256", render.film.sha256()},
      {"parts", std::move(parts)}};
  if (render.is_partial) render.statistics["partial"] = true;
  return render;
}

}  // namespace testbench
