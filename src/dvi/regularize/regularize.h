#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/regularize/labeling.h"

namespace dvi::regularize {

struct RegularizeOptions {
  bool enabled = false;
  int window = 5;
  int iterations = 20;
  double alpha = 20;  ///< of eq. 3, in gray levels over three channels; no label depends on it, only the energy

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("regularize", enabled, "Belief propagation over the hole (eqs. 2-4), as published; false keeps the candidates.");
    table.section("regularize");
    table.developer();
    table.add_one_of("window", window, {1, 3, 5, 7, 9, 11}, "Labels of a pixel: window x window pixels around its candidate.");
    table.add("iterations", iterations, {1, 1000}, "Most rounds of message passing.");
  }
};

/// Min-sum belief propagation over the 4-connected hole (section 3.3 of the paper). A pixel's labels are shifts of its
/// candidate; the data cost (eq. 3) asks that a boundary pixel's source continue into the true image, the discontinuity
/// cost (eq. 4) that neighbors' sources agree on each other's color, each neighbor warped by its own depth. Switched off, it
/// hands on the candidates as they are, and computes no energy.
Labeling regularize(sample::Candidates candidates, const depth::Target& target, const RegularizeOptions& options);

}  // namespace dvi::regularize
