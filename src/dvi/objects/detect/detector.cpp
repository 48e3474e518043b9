#include "dvi/objects/detect/detector.h"

#include <utility>

#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/objects/detect/decode.h"
#include "dvi/objects/detect/detection_tracker.h"
#include "dvi/objects/detect/network.h"

namespace dvi::objects {
namespace {

Label make_label(const TrackedObject& tracked, const Detector& detector, cv::Size image) {
  cv::Mat1b mask(image, uchar{0});
  tracked.object.mask.copyTo(mask(tracked.object.box));
  Label label;
  label.track = tracked.track;
  label.type = detector.classes()[static_cast<std::size_t>(tracked.object.type)];
  label.instance = to_outline(mask);
  return label;
}

}  // namespace

struct Detector::Impl {
  explicit Impl(const fs::path& model) : description(read_description(model)), network(model, description.outputs) {}

  Description description;
  Network network;
};

Detector::Detector(const fs::path& model) {
  require_regular_file(model);  // so that a missing network is reported before its description
  impl_ = std::make_unique<Impl>(model);
  detect({cv::Mat3b(impl_->description.input, cv::Vec3b::all(0))});
}

Detector::~Detector() = default;

std::vector<fs::path> Detector::files() const { return {impl_->description.model, impl_->description.file}; }

const std::vector<std::string>& Detector::classes() const { return impl_->description.classes; }

std::vector<Detections> Detector::detect(const std::vector<cv::Mat3b>& images) const {
  const Description& description = impl_->description;
  std::vector<InputFit> fits(images.size());
  std::vector<cv::Mat> blobs(images.size());
  parallel_for(images.size(), [&](std::size_t i) {
    fits[i] = fit_image(images[i].size(), description);
    blobs[i] = make_input_blob(images[i], fits[i], description);
  });
  std::vector<std::vector<cv::Mat>> outputs;
  for (const cv::Mat& blob : blobs) outputs.push_back(impl_->network.run(blob));
  std::vector<Detections> out(images.size());
  parallel_for(images.size(), [&](std::size_t i) { out[i] = decode(outputs[i], description, fits[i]); });
  return out;
}

FrameLabels detect_objects(const Drive& drive, const Detector& detector, const Tick& tick) {
  DetectionTracker tracker;
  FrameLabels labels(drive.frames.size());
  for_blocks(drive.frames.size(), [&](std::size_t first, std::size_t last) {
    std::vector<cv::Mat3b> images(last - first);
    parallel_for(images.size(), [&](std::size_t i) { images[i] = *drive.images[first + i]; });
    std::vector<Detections> found = detector.detect(images);
    for (std::size_t i = first; i < last; ++i) tracker.add(drive.frames[i].time_ns, std::move(found[i - first]));
    const std::vector<TrackedObject> objects = tracker.take();
    std::vector<Label> drawn(objects.size());
    parallel_for(objects.size(), [&](std::size_t i) { drawn[i] = make_label(objects[i], detector, images.front().size()); });
    for (std::size_t i = 0; i < objects.size(); ++i) labels[objects[i].frame].push_back(std::move(drawn[i]));
    for (std::size_t i = first; i < last; ++i) tick();
  });
  return labels;
}

}  // namespace dvi::objects
