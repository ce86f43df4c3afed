#pragma once

#include <memory>
#include <string>
#include <systemc>

#include "model/config/chip_config.hpp"
#include "model/control/control_unit.hpp"
#include "model/network/clear_connect.hpp"
#include "model/pe_array/pe_array.hpp"
#include "model/pe_array/poly_sram.hpp"
#include "model/pio/pio_engine.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

/// A multi-threaded array: a control unit, its PEs with their SRAM, and the PIO engine that serves them. A
/// CSX600 has one, a CSX700 has two on one network.
struct MtapArray {
  /// To be built within the chip's constructor, whose modules these become.
  /// @param prefix of the modules' names
  /// @param event_queue null when loosely timed
  MtapArray(const std::string& prefix, const ChipConfig& config, const ClockDomain& clock,
            EventQueue* event_queue);
  MtapArray(const MtapArray&) = delete;
  MtapArray& operator=(const MtapArray&) = delete;

  PeArray pe_array;
  ControlUnit control_unit;
  PolySram poly_sram;
  PioEngine pio_engine;
  Initiator pio = Initiator::pio;          ///< at the chip's network
  Initiator control = Initiator::control;  ///< likewise
};

}  // namespace model
