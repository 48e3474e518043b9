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
#include "dvi/bags/ros_cloud.h"
#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/text.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/input_place.h"
#include "dvi/exports/labeled_scans.h"

namespace dvi::exports {
namespace {

// An image or a scan in a bag: message `number` of a topic.
struct RecordedMessage {
  const bags::BagTopic* topic;
  std::size_t number;

  const bags::BagEntry& message() const { return topic->messages[number]; }
};

// The images of the cleaned cameras and the scans in the bag of a result.
class RecordedBag {
 public:
  RecordedBag(const RecordedInput& input, const Result& result)
      : messages_(input.path, bags::open_bag(input.path)),
        choice_(bags::choose_topics(input.path, messages_.bag(), input.read.topics)) {
    for (const ResultCamera& camera : result.cameras()) topics_.push_back(find_topic(camera.name));
  }

  const bags::Bag& bag() const { return messages_.bag(); }
  // Returns the topics of the cleaned cameras, in the order of the result.
  const std::vector<const bags::BagTopic*>& topics() const { return topics_; }
  // Returns the topic of the scans. Throws InputError if there is none.
  const bags::BagTopic& points() const {
    if (choice_.points) return *choice_.points;
    throw InputError(path(), "has depth images instead of scans, from which no points can be removed",
                     "export without --points");
  }
  const fs::path& path() const { return messages_.path(); }

  // Returns the images of the frames of a result, in their order.
  std::vector<RecordedMessage> find_images(const Result& result) const {
    std::vector<std::map<std::string, std::size_t>> numbers;  // by camera and name
    for (const bags::BagTopic* topic : topics_) numbers.push_back(number_images(*topic));
    std::vector<RecordedMessage> out;
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

  // Returns the messages of scans.
  std::vector<RecordedMessage> find_scans(const LabeledScans& scans) const {
    std::vector<RecordedMessage> out;
    for (const std::string& name : scans.names) {
      const std::optional<long long> number = to_integer(name);
      if (!number || *number < 0 || static_cast<std::size_t>(*number) >= points().messages.size())
        throw InputError(path(), fmt::format("has no scan {} of {}, which the run read", name, points().name), kSameRecording);
      out.push_back({&points(), static_cast<std::size_t>(*number)});
    }
    return out;
  }

  // Lists the other topics with scans, which show the traffic.
  std::vector<std::string> list_other_points() const {
    std::vector<std::string> out;
    for (const bags::BagTopic& other : bag().topics)
      if (&other != choice_.points && bags::is_scans(other) && !other.messages.empty()) out.push_back(other.name);
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

// Makes the messages with clean images, and those of scans without the returns of removed objects.
class CleanMessages {
 public:
  // No scans are changed if `scans` is empty.
  CleanMessages(const Result& result, const RecordedBag& bag, LabeledScans scans, int jpeg_quality)
      : result_(result),
        recorded_bag_(bag),
        scans_(std::move(scans)),
        jpeg_quality_(jpeg_quality),
        recorded_(bag.find_images(result)),
        images_(recorded_.size()) {
    for (const RecordedMessage& scan : bag.find_scans(scans_)) recorded_.push_back(scan);
  }

  // Returns the messages to replace in one file of the bag, numbered by frame, then by scan.
  bags::ReplacedMessages in_file(std::size_t file, Progress& progress) {
    bags::ReplacedMessages out;
    for (std::size_t i = 0; i < recorded_.size(); ++i) {
      const bags::BagEntry& entry = recorded_[i].message();
      if (entry.file == file) out.numbers[entry.chunk][entry.offset] = i;
    }
    out.replace = [this, &progress](std::size_t i, std::string_view message) {
      std::string clean = replace(i, message);
      ++copied_;
      if (i < images_) changed_ += clean == message ? 0 : 1;
      progress.advance();
      return clean;
    };
    return out;
  }

  std::size_t count_images() const { return images_; }
  std::size_t count_scans() const { return recorded_.size() - images_; }
  std::size_t size() const { return recorded_.size(); }
  std::size_t count_changed_images() const { return changed_; }
  std::size_t count_removed_points() const { return removed_points_; }
  // Throws InputError if a message was not found while the files were copied.
  void require_all_copied() const {
    if (copied_ != recorded_.size()) throw InputError(recorded_bag_.path(), "changed while it was copied", "export again");
  }

 private:
  std::string replace(std::size_t i, std::string_view message) {
    try {
      const std::string plain = bags::unpack_message(std::string(message));
      const std::string clean = i < images_ ? clean_image(i, plain) : clean_scan(i, plain);
      return clean == plain ? std::string(message) : bags::pack_message(clean, message);
    } catch (const std::invalid_argument& e) {
      refuse(i, e.what(),
             i < images_ ? "export the images in another format, such as dvi export mcap or video" : kSameRecording);
    }
  }

  std::string clean_image(std::size_t frame, const std::string& message) const {
    const bags::BagTopic& topic = *recorded_[frame].topic;
    const media::ImageEdit edit = result_.edit(frame);
    const std::optional<std::string> clean = bags::is_compressed(topic)
                                                 ? bags::edit_compressed_image(message, topic.encoding, edit, jpeg_quality_)
                                                 : bags::edit_image(message, topic.encoding, edit);
    if (!clean) refuse(frame, "it is not the image that the run cleaned", kSameRecording);
    return *clean;
  }

  std::string clean_scan(std::size_t i, const std::string& message) {
    const bags::BagTopic& topic = *recorded_[i].topic;
    const std::vector<bool> removed = find_removed_points(scans_, i - images_);
    removed_points_ += static_cast<std::size_t>(std::count(removed.begin(), removed.end(), true));
    return (bags::is_livox(topic) ? bags::remove_livox_points : bags::remove_cloud_points)(message, topic.encoding, removed);
  }

  [[noreturn]] void refuse(std::size_t i, const std::string& why, const char* remedy) const {
    throw InputError(recorded_bag_.path(),
                     fmt::format("message {} of {}: {}", recorded_[i].number, recorded_[i].topic->name, why), remedy);
  }

  const Result& result_;
  const RecordedBag& recorded_bag_;
  LabeledScans scans_;
  int jpeg_quality_;
  std::vector<RecordedMessage> recorded_;  // by frame, then by scan
  std::size_t images_;
  std::size_t copied_ = 0, changed_ = 0, removed_points_ = 0;
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
  const RecordedBag recorded(input, result);
  if (options.points) recorded.points();  // throws before the scans are labeled, which takes long
  CleanMessages clean(result, recorded, options.points ? result.label_scans(progress) : LabeledScans{}, options.quality);
  if (options.points) progress.begin("export bag", clean.size());
  const bool is_folder = fs::is_directory(input.path);
  ExportReport report;
  for (std::size_t file = 0; file < recorded.bag().files.size(); ++file) {
    const fs::path& from = recorded.bag().files[file];
    bags::copy_bag_file(from, is_folder ? place / from.filename() : place, clean.in_file(file, progress));
    report.files.push_back(from.filename());
  }
  clean.require_all_copied();
  if (is_folder)
    for (const char* name : {"metadata.yaml", "dvi.toml"})
      if (fs::exists(input.path / name)) write_file(place / name, read_file(input.path / name));
  std::vector<RecordedPart> images;
  for (std::size_t k = 0; k < recorded.topics().size(); ++k)
    images.push_back({recorded.topics()[k]->name, recorded.topics()[k]->messages.size(), result.count_frames(k)});
  const std::size_t others = warn_of_traffic(images, recorded.list_other_images(), progress);
  report.counts = {{"cleaned images", static_cast<double>(clean.count_images())},
                   {"of them changed", static_cast<double>(clean.count_changed_images())},
                   {"other images of the topics", static_cast<double>(others)}};
  if (!options.points) return report;
  warn_of_returns({recorded.points().name, recorded.points().messages.size(), clean.count_scans()},
                  recorded.list_other_points(), progress);
  report.counts.emplace_back("cleaned scans", static_cast<double>(clean.count_scans()));
  report.counts.emplace_back("removed points", static_cast<double>(clean.count_removed_points()));
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
  return {"bag",
          "the recorded bag (.bag, .mcap, .db3) with clean images; all other messages keep their bytes",
          write_bag,
          is_bag_file,
          {"export.quality", "export.input", "export.points"}};
}

}  // namespace dvi::exports
