#pragma once

#include <cstdint>

#include "firmware/cn/chip/label.hpp"
#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/transfer.hpp"
#include "model/observe/pio_observer.hpp"
#include "model/transaction/pe_addresses.hpp"

namespace model {

/// One request, from its arrival until its semaphore is signalled.
struct PioRequest {
  std::uint64_t id = 0;
  cn::PolySpan poly;
  cn::Semaphore done;
  PeAddresses addresses;
  int mono_range = 0;  ///< MonoWindow::range_of()
  PioEvent event;
  cn::Label label;
  cn::LaneMask enabled;  ///< kept for an observer only
};

}  // namespace model
