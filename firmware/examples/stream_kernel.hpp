#pragma once

#include "firmware/examples/kernels.hpp"

namespace examples {

inline void scale_and_add(const ScaleAndAddArguments& arguments) {
  for (int i = 0; i < arguments.elements; i += 4) {
    const cn::poly4<double> x = arguments.x.load(cn::four_from(i));
    cn::poly4<double> y = arguments.y.load(cn::four_from(i));
    for (int step = 0; step < arguments.steps; ++step)
      y.assign_all_lanes(multiply_add(y, arguments.factor, x));
    arguments.y.store(cn::four_from(i), y);
  }
}

}  // namespace examples
