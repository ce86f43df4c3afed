#include "model/pio/pio_engine.hpp"

#include <algorithm>

#include "firmware/cn/chip/access_observer.hpp"
#include "model/faults/fault_injector.hpp"
#include "model/pio/at_pio_service.hpp"
#include "model/pio/lt_pio_service.hpp"

namespace model {
namespace {

bool any_enabled(const cn::LaneMask& enabled, int num_pes) {
  for (int strip = 0; strip * cn::kStripLanes < num_pes; ++strip)
    if (enabled.strip_bits(strip) != 0) return true;
  return false;
}

}  // namespace

PioEngine::PioEngine(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
                     cn::PolyMemory& poly, EventQueue* event_queue)
    : sc_module(name),
      poly_(poly),
      rules_{Divisor(std::uint64_t(config.clear_connect.packet_bytes)),
             config.pio.consolidate_equal_addresses},
      timing_(config.pio),
      mono_(address_map(config), poly),
      requests_(config.pio, timing_, [this](int semaphore, Cycles at) { signal(semaphore, at); }),
      transactions_(clock, mono_socket, poly_socket, mono_) {
  port.bind(*this);
  mono_socket.register_invalidate_direct_mem_ptr(this, &PioEngine::forget_mono_pointer);
  if (event_queue == nullptr) {
    service_ = std::make_unique<LtPioService>(clock, config.pio.queue_depth, timing_, requests_,
                                              transactions_, [this](Cycles cycle) {
                                                if (time.size() > 0) time->approach(cycle);
                                              });
  } else {
    auto service = std::make_unique<AtPioService>(*event_queue, mono_socket, config, timing_, mono_,
                                                  requests_, transactions_);
    at_service_ = service.get();
    service_ = std::move(service);
    mono_socket.register_nb_transport_bw(this, &PioEngine::nb_transport_bw);
  }
}

PioEngine::~PioEngine() = default;

Cycles PioEngine::enqueue(const cn::Transfer& transfer, Cycles now) {
  settle(now);
  if (transfer.poly.size_bytes == 0 || !any_enabled(transfer.enabled, poly_.num_pes())) {
    requests_.skip(transfer, now);
    return now;
  }
  mono_.check_span(transfer, requests_.next_id());
  const Cycles accepted = wait_for_room(transfer.direction, now);
  PioRequest& request = requests_.unused();
  describe(transfer, request);
  if (!leaves_data_) move_data(transfer, request);
  service_->mono_changed();
  requests_.push(request, transfer, accepted);
  service_->start_due(accepted);
  PioStatistics& statistics = requests_.statistics();
  statistics.max_queue_depth = std::max(statistics.max_queue_depth, requests_.waiting());
  return accepted;
}

void PioEngine::signal(int semaphore, Cycles at) {
  if (faults_ == nullptr) return semaphores->signal_at(semaphore, at);
  const std::vector<Cycles> signals = faults_->signals(at);
  for (const Cycles each : signals) semaphores->signal_at(semaphore, each);
  // One signal too many: from now on a wait proves no request to be over, as the hazard checker is to know.
  if (signals.size() > 1 && poly_.observer() != nullptr) poly_.observer()->signalled({semaphore});
}

Cycles PioEngine::wait_for_room(cn::Direction direction, Cycles now) {
  Cycles accepted = now;
  while (requests_.full(direction)) accepted = std::max(accepted, service_->make_room());
  requests_.statistics().blocked_cycles += accepted - now;
  return accepted;
}

void PioEngine::describe(const cn::Transfer& transfer, PioRequest& request) {
  MonoPieces& pieces = request.addresses.pieces;
  pieces.describe(transfer, poly_.num_pes(), rules_);
  request.mono_range = mono_.range_of(pieces);
  if (request.mono_range != AddressMap::kNowhere) return;
  mono_.check_places(transfer, requests_.next_id());
  mono_.check_runs(transfer, pieces, requests_.next_id());
}

void PioEngine::move_data(const cn::Transfer& transfer, const PioRequest& request) {
  cn::Transfer of_copied_addresses = transfer;  // a scatter may overwrite a table of addresses
  of_copied_addresses.mono = request.addresses.pieces.places();
  mono_.move(of_copied_addresses, request.mono_range, *mono_socket.operator->());
}

void PioEngine::forget_mono_pointer(sc_dt::uint64, sc_dt::uint64) {
  mono_.invalidate();
}

tlm::tlm_sync_enum PioEngine::nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  return at_service_->nb_transport_bw(packet, phase, delay);
}

}  // namespace model
