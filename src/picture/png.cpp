#include <png.h>

#include "base/error.h"
#include "picture/preview.h"

namespace packmerger {

std::string png_bytes(const Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(image.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4)
    rgb.insert(rgb.end(), {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]});

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  const int written =
      png_image_write_to_memory(&png, bytes.data(), &size, 0, rgb.data(), 0, nullptr);
  if (written == 0)
    throw Error(Fault::kInternal, std::string("A picture could not be written: ") + png.message,
                "Please report this together with the model.");
  bytes.resize(size);
  return bytes;
}

}  // namespace packmerger
