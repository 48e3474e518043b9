#pragma once

#include "dvi/synth/paint.h"
#include "dvi/synth/texture.h"

namespace dvi::synth {

/// Paints the front of a house: a wall of brick, plaster or slabs, with windows and shops with signs.
TexturePtr paint_facade(Random random, const Noise& noise, double width_m, double height_m);
/// Paints a blade sign or a poster: words on a colored board.
TexturePtr paint_sign(Random random, const Noise& noise, double width_m, double height_m);
/// Paints the board of a barrier: red and white, 1.8 x 0.25 m.
TexturePtr paint_barrier(Random random, const Noise& noise);

}  // namespace dvi::synth
