#pragma once

#include <optional>
#include <span>
#include <string>

#include "dvi/core/files.h"
#include "dvi/media/video.h"

namespace dvi::result {

/// A segment of both videos of a camera.
struct MediaSegment {
  media::VideoSegment result;   ///< of video.mp4
  media::VideoSegment compare;  ///< of compare.mp4
};

/// Segments of videos that fills encoded, for the process that finishes the result, which only has to join them:
/// OUT/.dvi/video/NAME.bin has the segment that begins with frame NAME, and NAME.json is its manifest. A segment is valid if
/// the manifests of its frames list the same images as when it was encoded.
class SegmentStore {
 public:
  explicit SegmentStore(fs::path out);

  /// Returns whether all frames of a segment are finished, but the segment is not stored or no longer valid.
  bool lacks(std::span<const std::string> names) const;

  /// Returns the segment of these frames; none if it is not stored or no longer valid.
  std::optional<MediaSegment> read(std::span<const std::string> names) const;
  /// Stores the segment of finished frames. Throws InputError on a full or read-only disk.
  void write(std::span<const std::string> names, const MediaSegment& segment) const;
  /// Removes all segments.
  void remove_all() const;

 private:
  fs::path out_;
};

}  // namespace dvi::result
