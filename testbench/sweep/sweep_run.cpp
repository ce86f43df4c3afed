#include "testbench/sweep/sweep_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <deque>
#include <map>
#include <set>

#include "testbench/error.hpp"
#include "testbench/processes.hpp"
#include "testbench/sweep/point_work.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPollMilliseconds = 100;      ///< how soon a wish to stop is heard
constexpr int kRankPollMicroseconds = 500;  ///< how soon another rank gets its next point

constexpr const char* kReady = "ready";
constexpr const char* kStop = "stop";

Json inputs_json(const Sweep& sweep, const SweepPoint& point) {
  Json inputs = Json::object();
  for (std::size_t i = 0; i < point.inputs.size(); ++i) inputs[sweep.keys()[i]] = point.inputs[i];
  return inputs;
}

PointMode mode_of(const SweepPoint& point, bool replays) {
  return !replays ? PointMode::full : point.audited ? PointMode::audit : PointMode::replay;
}

/// The points that are left of one stream of calls.
struct StreamWork {
  enum class Stage : std::uint8_t { not_recorded, recording, recorded };

  std::deque<std::size_t> todo;
  bool replays = false;  ///< a recording pays for itself
  Stage stage = Stage::not_recorded;
  std::unique_ptr<Recording> recording;
};

class SweepRun {
 public:
  SweepRun(const Sweep& sweep, PointStore& store, const SweepRunOptions& options, Ranks& ranks,
           const SweepProgress& progress)
      : sweep_(sweep), store_(store), options_(options), ranks_(ranks), progress_(progress) {
    std::map<std::string, std::size_t> stream_of;
    std::set<std::string> taken;  // two points may be the same run
    for (std::size_t i = 0; i < sweep.points().size(); ++i) {
      const SweepPoint& point = sweep.points()[i];
      if (store.find(point.id) != nullptr || !taken.insert(point.id).second) continue;
      ++total_;
      if (!point.error.empty()) {
        without_run_.push_back(i);
        continue;
      }
      const auto [entry, is_new] = stream_of.emplace(point.stream, streams_.size());
      if (is_new) streams_.emplace_back();
      streams_[entry->second].todo.push_back(i);
    }
    for (StreamWork& stream : streams_) stream.replays = !options.in_full && stream.todo.size() > 1;
  }

  bool run() {
    for (const std::size_t i : without_run_) finish(i, failed_point(sweep_.points()[i].error));
    while (finished_ < total_) {
      if (!progress_(double(finished_) / double(total_))) return false;
      start_jobs();
      serve_ranks();
      wait();
    }
    progress_(1);
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, kStop);
    return true;
  }

 private:
  const SweepPoint& point(std::size_t i) const { return sweep_.points()[i]; }

  void finish(std::size_t i, Json result) {
    Json line = {{"inputs", inputs_json(sweep_, point(i))}};
    line.update(result);
    store_.add(point(i).id, std::move(line));
    ++finished_;
  }

  void start_jobs() {
    while (pool_.running() < options_.jobs && (start_point() || start_recording())) {
    }
  }

  /// Of a stream that is ready for it.
  bool start_point() {
    for (StreamWork& stream : streams_) {
      if (stream.todo.empty() || (stream.replays && stream.stage != StreamWork::Stage::recorded)) continue;
      const std::size_t i = stream.todo.front();
      stream.todo.pop_front();
      const Recording* const recording = stream.recording.get();
      const PointMode mode = mode_of(point(i), stream.replays);
      pool_.start(static_cast<int>(i), [&, recording, mode] { return run_point(point(i), recording, mode); });
      if (stream.todo.empty()) stream.recording.reset();  // the child has it
      return true;
    }
    return false;
  }

  bool start_recording() {
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      StreamWork& stream = streams_[s];
      if (stream.todo.empty() || !stream.replays || stream.stage != StreamWork::Stage::not_recorded) continue;
      stream.stage = StreamWork::Stage::recording;
      const SweepPoint& first = point(stream.todo.front());
      recorded_as_[s] = stream.todo.front();
      pool_.start(-1 - static_cast<int>(s),
                  [&first] { return encode(record_render(*first.scene, first.request.options)); });
      return true;
    }
    return false;
  }

  void take_recording(std::size_t s, const ProcessPool::Result& result) {
    StreamWork& stream = streams_[s];
    if (result.end == ProcessPool::End::done) {
      const SweepPoint& first = point(recorded_as_[s]);
      stream.recording =
          std::make_unique<Recording>(decode_recording(*first.scene, first.request.options, result.text));
      stream.stage = StreamWork::Stage::recorded;
      return;
    }
    stream.replays = false;  // each point then says for itself what is wrong with it
  }

  void take_result(const ProcessPool::Result& result) {
    if (result.job < 0) return take_recording(std::size_t(-1 - result.job), result);
    finish(std::size_t(result.job),
           result.end == ProcessPool::End::done ? Json::parse(result.text) : failed_point(result.text));
  }

  void wait() {
    if (ranks_.alone()) {
      if (const auto result = pool_.next(kPollMilliseconds)) take_result(*result);
      return;
    }
    if (const auto result = pool_.next(0)) {
      take_result(*result);
    } else {
      usleep(kRankPollMicroseconds);
    }
  }

  void serve_ranks() {
    while (const auto message = ranks_.try_receive()) {
      if (message->bytes != kReady) {
        const Json answer = Json::parse(message->bytes);
        finish(answer["point"].get<std::size_t>(), answer["result"]);
      }
      idle_ranks_.push_back(message->from);
    }
    while (!idle_ranks_.empty() && hand_out_to(idle_ranks_.front())) idle_ranks_.pop_front();
  }

  /// Points of one stream go to one rank, as long as there are others: it has the recording.
  bool hand_out_to(int rank) {
    const auto last = stream_of_rank_.find(rank);
    std::size_t chosen = streams_.size();
    if (last != stream_of_rank_.end() && !streams_[last->second].todo.empty()) chosen = last->second;
    if (chosen == streams_.size()) {
      const auto longest =
          std::max_element(streams_.begin(), streams_.end(),
                           [](const auto& a, const auto& b) { return a.todo.size() < b.todo.size(); });
      if (longest == streams_.end() || longest->todo.empty()) return false;
      chosen = std::size_t(longest - streams_.begin());
    }
    stream_of_rank_[rank] = chosen;
    StreamWork& stream = streams_[chosen];
    const std::size_t i = stream.todo.back();
    stream.todo.pop_back();
    ranks_.send(rank, Json{{"point", i}, {"id", point(i).id}, {"replays", stream.replays}}.dump());
    return true;
  }

  const Sweep& sweep_;
  PointStore& store_;
  SweepRunOptions options_;
  Ranks& ranks_;
  const SweepProgress& progress_;

  std::vector<StreamWork> streams_;
  std::map<std::size_t, std::size_t> recorded_as_;  ///< by stream: the point whose settings recorded it
  std::vector<std::size_t> without_run_;
  std::size_t total_ = 0;
  std::size_t finished_ = 0;
  std::map<int, std::size_t> stream_of_rank_;
  std::deque<int> idle_ranks_;
  ProcessPool pool_;
};

/// One rank's work, a point at a time, with the recording it used last.
class RankWork {
 public:
  explicit RankWork(const Sweep& sweep) : sweep_(sweep) {}

  Json run(const Json& order) {
    const auto i = order["point"].get<std::size_t>();
    if (i >= sweep_.points().size() || sweep_.points()[i].id != order["id"])
      return failed_point("another rank read another sweep: the ranks' files or programs differ");
    const SweepPoint& point = sweep_.points()[i];
    if (order["replays"]) record(point);
    const PointMode mode = mode_of(point, order["replays"] && recording_);
    try {
      return Json::parse(run_in_processes({[&] { return run_point(point, recording_.get(), mode); }}, 1)[0]);
    } catch (const std::exception& error) {
      return failed_point(error.what());
    }
  }

 private:
  void record(const SweepPoint& point) {
    if (stream_ == point.stream) return;
    stream_ = point.stream;
    recording_.reset();
    try {
      recording_ = std::make_unique<Recording>(record_render(*point.scene, point.request.options));
    } catch (const std::exception&) {
      // Run in full, each point says for itself what is wrong with it.
    }
  }

  const Sweep& sweep_;
  std::string stream_;
  std::unique_ptr<Recording> recording_;  ///< null if that failed
};

}  // namespace

bool run_sweep(const Sweep& sweep, PointStore& store, const SweepRunOptions& options, Ranks& ranks,
               const SweepProgress& progress) {
  return SweepRun(sweep, store, options, ranks, progress).run();
}

void serve_sweep(const Sweep& sweep, Ranks& ranks) {
  RankWork work(sweep);
  ranks.send(0, kReady);
  for (std::string order = ranks.receive().bytes; order != kStop; order = ranks.receive().bytes) {
    const Json json = Json::parse(order);
    ranks.send(0, Json{{"point", json["point"]}, {"result", work.run(json)}}.dump());
  }
}

}  // namespace testbench
