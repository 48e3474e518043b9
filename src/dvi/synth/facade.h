#pragma once

#include "dvi/synth/paint.h"
#include "dvi/synth/texture.h"

namespace dvi::synth {

/// The front of a house: wall of brick, plaster or slabs, windows, shops with signs.
TexturePtr paint_facade(Random random, const Noise& noise, double width_m, double height_m);
/// A blade sign, a poster: words on a colored board.
TexturePtr paint_sign(Random random, const Noise& noise, double width_m, double height_m);
/// The board of a barrier: red and white, 1.8 x 0.25 m.
TexturePtr paint_barrier(Random random, const Noise& noise);

}  // namespace dvi::synth
