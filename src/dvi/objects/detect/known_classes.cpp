#include "dvi/core/text.h"
#include "dvi/objects/detect/description.h"

namespace dvi::objects {
namespace {

// The classes of COCO in the order of their numbers from 1 to 90; "-": the number is not used.
constexpr const char* kCoco =
    "person,bicycle,car,motorcycle,airplane,bus,train,truck,boat,traffic light,fire hydrant,-,stop sign,parking meter,bench,"
    "bird,cat,dog,horse,sheep,cow,elephant,bear,zebra,giraffe,-,backpack,umbrella,-,-,handbag,tie,suitcase,frisbee,skis,"
    "snowboard,sports ball,kite,baseball bat,baseball glove,skateboard,surfboard,tennis racket,bottle,-,wine glass,cup,fork,"
    "knife,spoon,bowl,banana,apple,sandwich,orange,broccoli,carrot,hot dog,pizza,donut,cake,chair,couch,potted plant,bed,-,"
    "dining table,-,-,toilet,-,tv,laptop,mouse,remote,keyboard,cell phone,microwave,oven,toaster,sink,refrigerator,-,book,"
    "clock,vase,scissors,teddy bear,hair drier,toothbrush";
constexpr const char* kCityscapes =
    "road,sidewalk,building,wall,fence,pole,traffic light,traffic sign,vegetation,terrain,sky,person,rider,car,truck,bus,"
    "train,motorcycle,bicycle";

}  // namespace

std::vector<std::string> list_known_classes(const std::string& data_set) {
  if (data_set == "Cityscapes") return split_at_commas(kCityscapes);
  std::vector<std::string> classes;
  if (data_set != "COCO" && data_set != "COCO-91") return classes;
  const bool has_unused = data_set == "COCO-91";
  if (has_unused) classes.emplace_back("background");
  for (const std::string& name : split_at_commas(kCoco))
    if (has_unused || name != "-") classes.push_back(name);
  return classes;
}

}  // namespace dvi::objects
