#include "model/control/mono_access.hpp"

#include <cstring>
#include <string>

#include "firmware/cn/machine.hpp"
#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {

MonoAccess::MonoAccess(const ChipConfig& config, const ClockDomain& clock, CycleLedger& ledger,
                       TimeCoupling& time, cn::PolyMemory& poly_memory, tlm::tlm_initiator_socket<>& socket,
                       EventQueue* event_queue)
    : clock_(clock),
      miss_cycles_(Cycles(config.control.cache_miss_cycles)),
      ledger_(ledger),
      time_(time),
      socket_(socket),
      cache_(config.control.data_cache_bytes, config.control.cache_line_bytes),
      window_(address_map(config), poly_memory),
      at_transport_(event_queue != nullptr ? std::make_unique<AtTransport>(*event_queue, socket) : nullptr),
      line_(std::size_t(config.control.cache_line_bytes)) {}

const void* MonoAccess::read(cn::MonoAddress from, std::size_t bytes) {
  time_.approach(ledger_.now());
  const void* const data = read_untimed(from, bytes);
  const std::uint64_t last = cache_.line_of(from + bytes - 1);
  for (std::uint64_t line = cache_.line_of(from); line <= last; ++line) {
    if (cache_.touch(line)) {
      ++ledger_.statistics().data_cache_hits;
    } else {
      ++ledger_.statistics().data_cache_misses;
      time_.settle_pio(ledger_.now());
      send(tlm::TLM_READ_COMMAND, line * cache_.line_bytes(), line_.data(), line_.size());
    }
  }
  return data;
}

void MonoAccess::write(cn::MonoAddress to, const void* bytes, std::size_t size) {
  time_.settle_pio(ledger_.now());
  std::vector<std::uint8_t> data(size);
  std::memcpy(data.data(), bytes, size);
  send(tlm::TLM_WRITE_COMMAND, to, data.data(), size);
}

const void* MonoAccess::read_untimed(cn::MonoAddress from, std::size_t bytes) {
  return window_.view(from, bytes, memory());
}

void MonoAccess::write_untimed(cn::MonoAddress to, const void* bytes, std::size_t size) {
  window_.write(to, bytes, size, memory());
}

void MonoAccess::move_untimed(const cn::Transfer& transfer) {
  window_.check_span(transfer, 0);
  window_.check_places(transfer, 0);
  window_.move(transfer, window_.range_of(transfer), memory());
}

void MonoAccess::send(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data,
                      std::size_t size) {
  set_access(transaction_, command, address, data, size);
  ledger_.report_begin(CycleCause::data_cache);
  const Cycles over = transport();
  if (transaction_.is_response_error())
    throw cn::MachineFault("mono access of " + std::to_string(size) + " bytes at " + std::to_string(address) +
                           ": " + transaction_.get_response_string());
  ledger_.spend(CycleCause::data_cache, over - ledger_.now() + miss_cycles_);
}

Cycles MonoAccess::transport() {
  if (at_transport_) return at_transport_->transport(transaction_);
  sc_core::sc_time delay = delay_until(clock_, ledger_.now());
  socket_->b_transport(transaction_, delay);
  return cycle_of_delay(clock_, delay);
}

}  // namespace model
