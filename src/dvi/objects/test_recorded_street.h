#pragma once

#include <memory>

#include "dvi/drive/drive.h"
#include "dvi/synth/scene.h"

namespace dvi::objects {

// For tests only.

/// A synthetic street without labels, in small images and with scans of few columns.
struct RecordedStreet {
  std::shared_ptr<const synth::Scene> scene;
  Drive drive;

  explicit RecordedStreet(int frames, int seed = 1) {
    synth::SynthOptions options;
    options.frames = frames;
    options.seed = seed;
    options.columns = 900;
    options.width = 320;
    options.height = 180;
    scene = std::make_shared<const synth::Scene>(options);
    drive = synth::drive_of(scene);
    for (Frame& frame : drive.frames) frame.labels.clear();
  }
};

}  // namespace dvi::objects
