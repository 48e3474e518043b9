#include "dvi/objects/detect/detector.h"

#include <utility>

#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/objects/detect/decode.h"
#include "dvi/objects/detect/detection_tracker.h"
#include "dvi/objects/detect/network.h"

namespace dvi::objects {
namespace {

constexpr int kTrialSide = 640;  // side of the empty image on which a network without a fixed size is tried

Label make_label(const TrackedObject& tracked, const Detector& detector, cv::Size image) {
  Label label;
  label.track = tracked.track;
  label.type = detector.classes()[static_cast<std::size_t>(tracked.object.type)];
  if (tracked.object.is_box) {
    label.rect = cv::Rect2d(tracked.object.box);
    return label;
  }
  cv::Mat1b mask(image, uchar{0});
  tracked.object.mask.copyTo(mask(tracked.object.box));
  label.instance = to_outline(mask);
  return label;
}

}  // namespace

struct Detector::Impl {
  explicit Impl(const OnnxFile& file) : description(describe_network(file)), network(open_network(file, description.outputs)) {
    // The outputs for an empty image show their layout, and whether the engine can run the network.
    const cv::Size size = description.input.empty() ? cv::Size(kTrialSide, kTrialSide) : description.input;
    const cv::Mat3b image(size, cv::Vec3b::all(0));
    const std::vector<Tensor> outputs = network->run(make_input_blob(image, fit_image(size, description), description));
    if (description.layout == Layout::automatic) description.layout = recognize_layout(outputs, description);
    decode(outputs, description, fit_image(size, description));
  }

  Detections detect(const cv::Mat3b& image) const {
    const InputFit fit = fit_image(image.size(), description);
    return decode(network->run(make_input_blob(image, fit, description)), description, fit);
  }

  Description description;
  std::unique_ptr<Network> network;
};

Detector::Detector(const fs::path& model) : impl_(std::make_unique<Impl>(read_onnx_file(model))) {}

Detector::~Detector() = default;

std::vector<fs::path> Detector::files() const { return impl_->description.files; }

std::string Detector::engine() const { return impl_->network->engine(); }

void Detector::choose(const std::set<std::string, std::less<>>& names) { choose_classes(names, impl_->description); }

const std::vector<std::string>& Detector::classes() const { return impl_->description.classes; }

std::vector<Detections> Detector::detect(const std::vector<cv::Mat3b>& images) const {
  std::vector<Detections> out(images.size());
  if (impl_->network->runs_in_parallel()) {
    parallel_for(images.size(), [&](std::size_t i) { out[i] = impl_->detect(images[i]); });
    return out;
  }
  for (std::size_t i = 0; i < images.size(); ++i) out[i] = impl_->detect(images[i]);
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
