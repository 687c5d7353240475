// The one place that makes and destroys OSMesa contexts; private to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include <GL/osmesa.h>

namespace packmerger {

// A drawing surface of width × height pixels with 24 bits of depth or more. It is current on the
// calling thread from its making until another one is made current there.
class DrawingSurface {
 public:
  DrawingSurface(int width, int height);
  DrawingSurface(const DrawingSurface&) = delete;
  DrawingSurface& operator=(const DrawingSurface&) = delete;
  ~DrawingSurface();

  int width() const { return width_; }
  int height() const { return height_; }
  void make_current();

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  OSMesaContext context_;
};

}  // namespace packmerger
