// The one place that makes and destroys OSMesa contexts; private to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include <GL/osmesa.h>

namespace packmerger {

// A drawing surface of width × height pixels with 24 bits of depth.
class DrawingSurface {
 public:
  DrawingSurface(int width, int height);
  DrawingSurface(const DrawingSurface&) = delete;
  DrawingSurface& operator=(const DrawingSurface&) = delete;
  ~DrawingSurface();

  int width() const { return width_; }
  int height() const { return height_; }

  // While alive, OpenGL calls of this thread draw on the surface. No thread keeps a surface longer
  // than that, so that it may be destroyed by another thread than the one that drew on it.
  class Current {
   public:
    explicit Current(DrawingSurface& surface);
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
    ~Current();
  };

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  OSMesaContext context_;
};

}  // namespace packmerger
