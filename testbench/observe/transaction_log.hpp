#pragma once

#include <deque>
#include <filesystem>

#include "model/csx600.hpp"
#include "model/observe/chip_observer.hpp"
#include "testbench/files/output_stream.hpp"

namespace testbench {

/// Writes a line of JSON for each request of programmed I/O, in the order in which they started, and for each
/// transfer between host and mono memory:
///
///   request      id, ascending in the order of enqueueing; null for the host
///   kind         load (mono to poly), save (poly to mono), upload, download
///   stage, block stage and block that the firmware labels it with; null without a label
///   semaphore    name of the semaphore that it signals; null if none
///   bytes, pes   bytes moved in all PEs, and number of PEs that take part
///   enqueued, started, finished   cycles
///   waited_for   cycles for which the control unit waited for this request
///
/// The sum of waited_for over all lines is the number of cycles that the control unit spent in wait_load and
/// wait_save.
class TransactionLog : public model::ChipObserver {
 public:
  /// Throws InputError if the file cannot be created.
  TransactionLog(const std::filesystem::path& file, const model::Csx600& chip, int array);

  void spent(model::CycleCause cause, model::Cycles start, model::Cycles finish, int semaphore) override;
  void finished(const model::PioEvent& event) override;
  void ended_transfer(bool upload, std::uint64_t bytes, model::Cycles start, model::Cycles finish) override;

  /// Must be called after the run. Throws RunError if the file is not complete.
  void finish();

 private:
  struct Transaction {
    model::PioEvent event;
    model::Cycles waited_for = 0;
  };

  void write(const Transaction& transaction);
  void write_line(const std::string& line);
  void write_before(model::Cycles cycle);

  const model::ControlUnit& control_unit_;
  StreamedFile file_;
  std::string buffer_;
  std::deque<Transaction> open_;  ///< requests that the control unit may still wait for
};

}  // namespace testbench
