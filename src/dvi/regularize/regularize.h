#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/regularize/labeling.h"

namespace dvi::regularize {

/// Options of regularize(); describe() documents each field.
struct RegularizeOptions {
  bool enabled = false;
  int window = 5;
  int iterations = 20;
  double alpha = 20;  ///< The constant of eq. 3, in gray levels over three channels. It affects the energy, but not the labels.

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("regularize", enabled, "Belief propagation over the hole (eqs. 2-4), as published; false keeps the candidates.");
    table.section("regularize");
    table.developer();
    table.add_one_of("window", window, {1, 3, 5, 7, 9, 11}, "Labels of a pixel: window x window pixels around its candidate.");
    table.add("iterations", iterations, {1, 1000}, "Maximum number of iterations of message passing.");
  }
};

/// Shifts the candidates by min-sum belief propagation over the 4-connected hole (section 3.3 of the paper). A pixel's labels
/// are shifts of its candidate. The data cost (eq. 3) is the difference at the boundary between the source and the image. The
/// discontinuity cost (eq. 4) is the difference of the sources of neighbors, each warped by its own depth. If disabled, it
/// returns the candidates without changes and without energies. Throws UsageError if `window` is even.
Labeling regularize(sample::Candidates candidates, const depth::Target& target, const RegularizeOptions& options);

}  // namespace dvi::regularize
