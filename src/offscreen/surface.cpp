#include "offscreen/surface.h"

#include "base/error.h"

namespace packmerger {
namespace {

[[noreturn]] void refuse() {
  throw Error(Fault::kInternal, "OSMesa gives no drawing surface",
              "Check that libosmesa6 is installed and that there is memory left.");
}

}  // namespace

DrawingSurface::DrawingSurface(int width, int height)
    : width_(width),
      height_(height),
      pixels_(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      context_(OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, nullptr)) {
  if (context_ == nullptr) refuse();
}

DrawingSurface::~DrawingSurface() { OSMesaDestroyContext(context_); }

DrawingSurface::Current::Current(DrawingSurface& surface) {
  if (OSMesaMakeCurrent(surface.context_, surface.pixels_.data(), GL_UNSIGNED_BYTE, surface.width_,
                        surface.height_) == GL_FALSE)
    refuse();
}

DrawingSurface::Current::~Current() { OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0); }

}  // namespace packmerger
