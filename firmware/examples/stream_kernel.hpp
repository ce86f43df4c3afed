#pragma once

#include "firmware/examples/kernels.hpp"

namespace examples {

inline void scale_and_add(const ScaleAndAddArguments& arguments) {
  for (int i = 0; i < arguments.elements; i += 4)
    arguments.y.store(cn::four_from(i), multiply_add(arguments.x.load(cn::four_from(i)), arguments.factor,
                                                     arguments.y.load(cn::four_from(i))));
}

}  // namespace examples
