#include "testbench/sweep/sweep_run.hpp"

#include <unistd.h>

#include <deque>
#include <set>

#include "testbench/statistics/json_file.hpp"
#include "testbench/sweep/point_work.hpp"
#include "testbench/sweep/sweep_plan.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/time_limit.hpp"
#include "testbench/system/workers.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPollMilliseconds = 100;  ///< the longest that a request to stop waits
constexpr int kRankPollMilliseconds = 1;

constexpr const char* kReady = "ready";
constexpr const char* kStop = "stop";

/// Answers orders for points, in worker processes and on other ranks.
class PointServer {
 public:
  PointServer(const Sweep& sweep, double limit_seconds) : sweep_(sweep), limit_seconds_(limit_seconds) {}

  /// { point, id, replays } to { point, result: a PointStore line }. Does not throw.
  std::string answer(const std::string& text) {
    const Json order = Json::parse(text);
    return json_text({{"point", order["point"]}, {"result", run(order)}});
  }

 private:
  Json run(const Json& order) {
    const auto i = order["point"].get<std::size_t>();
    if (i >= sweep_.points().size() || sweep_.points()[i].id != order["id"])
      return failed_point("another rank read another sweep: the ranks' files or programs differ");
    const SweepPoint& point = sweep_.points()[i];
    if (order["replays"]) record(point);
    const bool replays = order["replays"] && recording_;
    const PointMode mode = !replays ? PointMode::full : point.audited ? PointMode::audit : PointMode::replay;
    try {
      const auto work = [&] { return run_point(point, recording_.get(), mode); };
      return Json::parse(run_in_processes({work}, 1, {}, limit_seconds_)[0]);
    } catch (const std::exception& error) {
      return failed_point(error.what());
    }
  }

  void record(const SweepPoint& point) {
    if (stream_ == point.stream) return;
    stream_ = point.stream;
    recording_.reset();
    // The end of this process is what is left to stop a firmware that never ends; the point fails by it.
    const TimeLimit limit(limit_seconds_, [](const std::string&) { _exit(1); });
    try {
      recording_ = std::make_unique<PointRecording>(record_point(point));
    } catch (const std::exception&) {
      // Run in full, each point says for itself what is wrong with it.
    }
  }

  const Sweep& sweep_;
  double limit_seconds_;
  std::string stream_;
  std::unique_ptr<PointRecording> recording_;  ///< null if that failed
};

/// The first rank's part. Server 0 to jobs - 1 are its workers, -1, -2, ... the other ranks.
class SweepRun {
 public:
  SweepRun(const Sweep& sweep, PointStore& store, const SweepRunOptions& options, Ranks& ranks)
      : sweep_(sweep),
        store_(store),
        ranks_(ranks),
        left_(points_left()),
        plan_(sweep, left_, options.in_full) {
    const auto jobs = static_cast<int>(std::min(std::size_t(options.jobs), left_.size()));
    workers_.emplace(jobs, [&sweep, limit = options.limit_seconds] {
      const auto server = std::make_shared<PointServer>(sweep, limit);
      return [server](const std::string& order) { return server->answer(order); };
    });
    for (int worker = 0; worker < jobs; ++worker) idle_.push_back(worker);
    orders_.resize(std::size_t(jobs));
  }

  bool run(const SweepProgress& progress) {
    const std::size_t total = finished_ + left_.size();
    while (finished_ < total) {
      if (!progress(double(finished_) / double(total))) return false;
      hand_out();
      take_results();
    }
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, kStop);
    return true;
  }

 private:
  const SweepPoint& point(std::size_t i) const { return sweep_.points()[i]; }

  /// What cannot run is finished here. Two points may be the same run.
  std::vector<std::size_t> points_left() {
    std::vector<std::size_t> left;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < sweep_.points().size(); ++i) {
      if (!point(i).excluded.empty()) continue;
      if (store_.find(point(i).id) != nullptr || !taken.insert(point(i).id).second) continue;
      if (point(i).error.empty()) {
        left.push_back(i);
      } else {
        finish(i, failed_point(point(i).error));
      }
    }
    return left;
  }

  void finish(std::size_t i, const Json& result) {
    Json line = {{"inputs", Json::object()}};
    for (std::size_t k = 0; k < point(i).inputs.size(); ++k)
      line["inputs"][sweep_.keys()[k]] = point(i).inputs[k];
    line.update(result);
    store_.add(point(i).id, std::move(line));
    ++finished_;
  }

  void hand_out() {
    for (; !idle_.empty(); idle_.pop_front()) {
      const int server = idle_.front();
      const std::optional<SweepPlan::Order> order = plan_.next(server);
      if (!order) return;
      const std::string text =
          json_text({{"point", order->point}, {"id", point(order->point).id}, {"replays", order->replays}});
      if (server < 0) {
        ranks_.send(-server, text);
      } else {
        orders_[std::size_t(server)] = order->point;
        workers_->send(server, text);
      }
    }
  }

  void take_results() {
    if (const auto reply = workers_->next(ranks_.alone() ? kPollMilliseconds : kRankPollMilliseconds)) {
      if (reply->text) {
        take(*reply->text);
      } else {
        finish(orders_[std::size_t(reply->worker)],
               failed_point("the run ended without a result (signal or crash)"));
      }
      idle_.push_back(reply->worker);
    }
    while (const auto message = ranks_.try_receive()) {
      if (message->bytes != kReady) take(message->bytes);
      idle_.push_back(-message->from);
    }
  }

  void take(const std::string& text) {
    const Json answer = Json::parse(text);
    finish(answer["point"].get<std::size_t>(), answer["result"]);
  }

  const Sweep& sweep_;
  PointStore& store_;
  Ranks& ranks_;
  std::size_t finished_ = 0;
  std::vector<std::size_t> left_;
  SweepPlan plan_;
  std::optional<Workers> workers_;
  std::vector<std::size_t> orders_;  ///< by worker: its point
  std::deque<int> idle_;
};

}  // namespace

bool run_sweep(const Sweep& sweep, PointStore& store, const SweepRunOptions& options, Ranks& ranks,
               const SweepProgress& progress) {
  return SweepRun(sweep, store, options, ranks).run(progress);
}

void serve_sweep(const Sweep& sweep, Ranks& ranks, double limit_seconds) {
  PointServer server(sweep, limit_seconds);
  ranks.send(0, kReady);
  for (std::string order = ranks.receive().bytes; order != kStop; order = ranks.receive().bytes)
    ranks.send(0, server.answer(order));
}

}  // namespace testbench
