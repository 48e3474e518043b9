#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/bags/bag_frame_numbers.h"
#include "dvi/bags/bag_messages.h"
#include "dvi/bags/bag_topics.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/text.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/input_place.h"

namespace dvi::exports {
namespace {

// An image in a bag: message `number` of a topic.
struct RecordedImage {
  const bags::BagTopic* topic;
  std::size_t number;

  const bags::BagEntry& message() const { return topic->messages[number]; }
};

// The images of the cleaned cameras in the bag of a result.
class BagImages {
 public:
  BagImages(const RecordedInput& input, const Result& result)
      : messages_(input.path, bags::open_bag(input.path)),
        choice_(bags::choose_topics(input.path, messages_.bag(), input.read.topics)) {
    for (const ResultCamera& camera : result.cameras()) topics_.push_back(find_topic(camera.name));
  }

  const bags::Bag& bag() const { return messages_.bag(); }
  // Returns the topics of the cleaned cameras, in the order of the result.
  const std::vector<const bags::BagTopic*>& topics() const { return topics_; }
  const fs::path& path() const { return messages_.path(); }

  // Returns the images of the frames of a result, in their order.
  std::vector<RecordedImage> find_images(const Result& result) const {
    std::vector<std::map<std::string, std::size_t>> numbers;  // by camera and name
    for (const bags::BagTopic* topic : topics_) numbers.push_back(number_images(*topic));
    std::vector<RecordedImage> out;
    for (const ResultFrame& frame : result.frames()) {
      const bags::BagTopic* const topic = topics_[frame.camera];
      const auto found = numbers[frame.camera].find(image_of_frame(frame.name));
      if (found == numbers[frame.camera].end())
        throw InputError(path(), fmt::format("has no image {} of {}, which the run cleaned", frame.name, topic->name),
                         kSameRecording);
      out.push_back({topic, found->second});
    }
    return out;
  }

  // Lists the other topics with images, which show the traffic.
  std::vector<std::string> list_other_images() const {
    std::vector<std::string> out;
    for (const bags::BagTopic& other : bag().topics)
      if (std::find(topics_.begin(), topics_.end(), &other) == topics_.end() && bags::is_images(other) &&
          !other.messages.empty() && &other != choice_.depth.images)
        out.push_back(other.name);
    return out;
  }

 private:
  const bags::BagTopic* find_topic(const std::string& camera) const {
    for (const bags::BagCamera& recorded : choice_.cameras)
      if (recorded.name == camera) return recorded.images;
    throw InputError(path(), fmt::format("has no camera {}, which the run cleaned", camera), kSameRecording);
  }

  // Returns the numbers of the messages of a topic by the names of their frames.
  std::map<std::string, std::size_t> number_images(const bags::BagTopic& topic) const {
    std::vector<std::string> warnings;  // the run printed them
    const std::vector<bags::StampedEntry> entries = messages_.list_stamped(topic, warnings);
    const bags::FrameNumbers numbers = bags::number_frames(messages_, topic, entries);
    std::map<std::string, std::size_t> out;
    for (const bags::StampedEntry& entry : entries) out[bags::frame_name(numbers.number(topic, entry.number))] = entry.number;
    return out;
  }

  bags::BagMessages messages_;
  bags::BagChoice choice_;
  std::vector<const bags::BagTopic*> topics_;
};

// Makes the messages with clean images.
class CleanMessages {
 public:
  CleanMessages(const Result& result, const BagImages& images, int jpeg_quality)
      : result_(result), images_(images), jpeg_quality_(jpeg_quality), recorded_(images.find_images(result)) {}

  // Returns the messages to replace in one file of the bag, numbered by frame.
  bags::ReplacedMessages in_file(std::size_t file, Progress& progress) {
    bags::ReplacedMessages out;
    for (std::size_t frame = 0; frame < recorded_.size(); ++frame) {
      const bags::BagEntry& entry = recorded_[frame].message();
      if (entry.file == file) out.numbers[entry.chunk][entry.offset] = frame;
    }
    out.replace = [this, &progress](std::size_t frame, std::string_view message) {
      std::string clean = replace(frame, message);
      ++copied_;
      changed_ += clean == message ? 0 : 1;
      progress.advance();
      return clean;
    };
    return out;
  }

  std::size_t size() const { return recorded_.size(); }
  std::size_t changed() const { return changed_; }
  // Throws InputError if a message was not found while the files were copied.
  void require_all_copied() const {
    if (copied_ != recorded_.size()) throw InputError(images_.path(), "changed while it was copied", "export again");
  }

 private:
  std::string replace(std::size_t frame, std::string_view message) const {
    const auto& [topic_of_frame, number] = recorded_[frame];
    const bags::BagTopic& topic = *topic_of_frame;
    const std::string where = fmt::format("message {} of {}", number, topic.name);
    const auto fail = [&](const std::string& why, const char* remedy) {
      throw InputError(images_.path(), fmt::format("{}: {}", where, why), remedy);
    };
    std::optional<std::string> clean;
    std::string plain;
    try {
      plain = bags::unpack_message(std::string(message));
      const media::ImageEdit edit = result_.edit(frame);
      clean = bags::is_compressed(topic) ? bags::edit_compressed_image(plain, topic.encoding, edit, jpeg_quality_)
                                         : bags::edit_image(plain, topic.encoding, edit);
    } catch (const std::invalid_argument& e) {
      fail(e.what(), "export the images in another format, such as dvi export mcap or video");
    }
    if (!clean) fail("it is not the image that the run cleaned", kSameRecording);
    return *clean == plain ? std::string(message) : bags::pack_message(*clean, message);
  }

  const Result& result_;
  const BagImages& images_;
  int jpeg_quality_;
  std::vector<RecordedImage> recorded_;  // by frame
  std::size_t copied_ = 0, changed_ = 0;
};

RecordedInput find_bag(const Result& result, const ExportOptions& options) {
  RecordedInput input = find_input(result, options);
  if (!fs::exists(input.path)) throw InputError(input.path, "does not exist", kSameRecording);
  if (!bags::is_bag(input.path))
    throw InputError(input.path, "is not a bag", "export the recording in its own layout: dvi export folder");
  return input;
}

ExportReport write_bag(const Result& result, const fs::path& place, const ExportOptions& options, Progress& progress) {
  const RecordedInput input = find_bag(result, options);
  const BagImages images(input, result);
  CleanMessages clean(result, images, options.quality);
  const bool is_folder = fs::is_directory(input.path);
  ExportReport report;
  for (std::size_t file = 0; file < images.bag().files.size(); ++file) {
    const fs::path& from = images.bag().files[file];
    bags::copy_bag_file(from, is_folder ? place / from.filename() : place, clean.in_file(file, progress));
    report.files.push_back(from.filename());
  }
  clean.require_all_copied();
  if (is_folder)
    for (const char* name : {"metadata.yaml", "dvi.toml"})
      if (fs::exists(input.path / name)) write_file(place / name, read_file(input.path / name));
  std::vector<CameraImages> recorded;
  for (std::size_t k = 0; k < images.topics().size(); ++k)
    recorded.push_back({images.topics()[k]->name, images.topics()[k]->messages.size(), result.count_frames(k)});
  const std::size_t others = warn_of_traffic(recorded, images.list_other_images(), progress);
  report.counts = {{"cleaned images", static_cast<double>(clean.size())},
                   {"of them changed", static_cast<double>(clean.changed())},
                   {"other images of the topics", static_cast<double>(others)}};
  return report;
}

// A bag that is one file is exported to a file.
bool is_bag_file(const Result& result, const ExportOptions& options, const fs::path& place) {
  const RecordedInput input = find_bag(result, options);
  require_outside(place, input.path);
  if (fs::is_directory(input.path)) {
    if (bags::has_bag_ending(place))
      throw InputError(place, fmt::format("is a file, but the recording {} is a folder", input.path.string()),
                       "give a new folder");
    return false;
  }
  const std::string ending = input.path.extension().string();
  if (to_lower_case(place.extension().string()) != to_lower_case(ending))
    throw InputError(
        place, fmt::format("does not end in {} as the recording does", ending),
        fmt::format("give a file of the format of the recording, such as clean{}; bags are not converted", ending));
  if (fs::exists(place)) throw InputError(place, "exists", "choose another file");
  return true;
}

}  // namespace

ExportFormat bag_format() {
  return {"bag", "the recorded bag (.bag, .mcap, .db3) with clean images; all other messages keep their bytes", write_bag,
          is_bag_file};
}

}  // namespace dvi::exports
