#pragma once

#include "dvi/drive/label.h"

namespace dvi::objects {

/// Sets the source of all labels.
void set_source(FrameLabels& labels, MaskSource source);

/// Returns the number after the highest track number.
int next_track(const FrameLabels& labels);

/// Appends labels frame by frame. Their tracks are numbered from `first_track` on.
void append(FrameLabels& labels, FrameLabels more, int first_track);

}  // namespace dvi::objects
