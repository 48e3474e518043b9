#include "dvi/drive/traffic_classes.h"

#include <cctype>

namespace dvi {

const std::set<std::string, std::less<>>& traffic_classes() {
  static const std::set<std::string, std::less<>> names{
      "person", "people",     "pedestrian", "rider",   "cyclist", "bicyclist", "motorcyclist", "bicycle",
      "bike",   "motorcycle", "motorbike",  "scooter", "car",     "van",       "truck",        "lorry",
      "bus",    "coach",      "trailer",    "caravan", "train",   "tram",      "vehicle",      "animal",
      "bird",   "cat",        "dog",        "horse",   "sheep",   "cow",       "deer"};
  return names;
}

bool is_traffic_class(const std::string& name) {
  // Further names for such classes in data sets.
  static const std::set<std::string, std::less<>> further{"walker",      "human",  "vehicles",  "cars",
                                                          "pedestrians", "misc",   "suv",       "pickup",
                                                          "taxi",        "wheels", "emergency", "construction"};
  std::string word;
  for (const char c : name + " ") {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (traffic_classes().contains(word) || further.contains(word)) return true;
    word.clear();
  }
  return false;
}

}  // namespace dvi
