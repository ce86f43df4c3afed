#include "testbench/observe/transaction_log.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

TransactionLog::TransactionLog(const std::filesystem::path& file, const model::Csx600& chip, int array)
    : control_unit_(chip.array(array).control_unit), file_(file) {}

void TransactionLog::finished(const model::PioEvent& event) {
  open_.push_back({event, 0});
}

/// A wait ends in the cycle in which its request finishes. Spans are reported in order of time.
void TransactionLog::spent(model::CycleCause cause, model::Cycles start, model::Cycles finish,
                           int semaphore) {
  if (cause == model::CycleCause::wait_load || cause == model::CycleCause::wait_save) {
    const auto found = std::find_if(open_.begin(), open_.end(), [&](const Transaction& transaction) {
      return transaction.event.semaphore == semaphore && transaction.event.finished == finish &&
             transaction.waited_for == 0;
    });
    if (found != open_.end()) found->waited_for = finish - start;
  }
  write_before(finish);
}

void TransactionLog::write_before(model::Cycles cycle) {
  for (; !open_.empty() && open_.front().event.finished < cycle; open_.pop_front()) write(open_.front());
}

void TransactionLog::write(const Transaction& transaction) {
  const model::PioEvent& event = transaction.event;
  Json line;
  line["request"] = event.id;
  line["kind"] = event.direction == cn::Direction::mono_to_poly ? "load" : "save";
  line["stage"] = event.label.stage == nullptr ? Json() : Json(event.label.stage);
  line["block"] = event.label.stage == nullptr ? Json() : Json(event.label.block);
  line["semaphore"] = event.semaphore < 0 ? Json() : Json(control_unit_.semaphore_name({event.semaphore}));
  line["bytes"] = event.bytes;
  line["pes"] = event.pes;
  line["enqueued"] = event.enqueued;
  line["started"] = event.started;
  line["finished"] = event.finished;
  line["waited_for"] = transaction.waited_for;
  write_line(line.dump());
}

void TransactionLog::ended_transfer(bool upload, std::uint64_t bytes, model::Cycles start,
                                    model::Cycles finish) {
  const Json line = {{"request", nullptr},
                     {"kind", upload ? "upload" : "download"},
                     {"stage", nullptr},
                     {"block", nullptr},
                     {"semaphore", nullptr},
                     {"bytes", bytes},
                     {"pes", 0},
                     {"enqueued", start},
                     {"started", start},
                     {"finished", finish},
                     {"waited_for", 0}};
  write_line(line.dump());
}

void TransactionLog::write_line(const std::string& line) {
  buffer_ += line;
  buffer_ += '\n';
  if (buffer_.size() < kWriteBufferBytes) return;
  file_.write(buffer_);
  buffer_.clear();
}

void TransactionLog::finish() {
  write_before(std::numeric_limits<model::Cycles>::max());
  file_.write(buffer_);
  file_.finish();
}

}  // namespace testbench
