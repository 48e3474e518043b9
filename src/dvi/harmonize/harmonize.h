#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

struct HarmonizeOptions {
  bool poisson = true;
  bool seam_gradients = true;
  bool unseen_last = true;
  double unseen_vertical = 0.1;
  bool fill_unseen = true;

  void describe(OptionTable& table) {
    table.section("harmonize");
    table.add("poisson", poisson, "Solve eq. 5 so that copies meet their surroundings without a seam; false copies as is.");
    table.add("seam_gradients", seam_gradients,
              "Between pixels of different sources ask for the gradient the sources show; false: 0, as published.");
    table.add("unseen_last", unseen_last,
              "Interpolate unseen pixels after the copies are solved; false: together, as published, which lets them bleed.");
    table.add("unseen_vertical", unseen_vertical, {0.001, 1},
              "Weight of vertical against horizontal neighbours in that interpolation: structure mostly follows image rows; 1: "
              "a membrane.");
    table.add("fill_unseen", fill_unseen, "Interpolate pixels that no frame saw; false leaves them black, kind 5.");
  }
};

/// Colours the hole from its candidates (eq. 5): per hole a Poisson equation with the surrounding image as Dirichlet
/// boundary (Neumann at the image's border). Its guidance is the gradient of the copies, between pixels of different sources
/// what these show there, and 0 at pixels without a source, which are interpolated once the copies stand.
FilledFrame harmonize(const sample::Candidates& candidates, const Views& views, std::size_t target,
                      const depth::DepthMap& depth, const HarmonizeOptions& options);

}  // namespace dvi::harmonize
