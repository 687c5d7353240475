// One function a verb of packmerger-bench; each adds it to the program.
#pragma once

#include <CLI/CLI.hpp>

namespace packmerger::bench {

// How much smoothing straightens the cuts of a model, as figures and as a picture.
void add_cuts(CLI::App& program);

// The packer's inner loops against plain loops, OSMesa and the least they have to do.
void add_kernels(CLI::App& program);

// How near the links come to what a serial line allows, and what they cost the processor.
void add_link(CLI::App& program);

// The packer against the paper's: how many times faster, at the same answers.
void add_pack(CLI::App& program);

// The paper's figures and Table 1.
void add_figures(CLI::App& program);

// The figures of docs/PACKING, each tray checked on its meshes.
void add_packing_table(CLI::App& program);

// The paper's packer, simple and slow, on a model's segments.
void add_reference(CLI::App& program);

// Divisions of a model by planes and by clusters, and how much support their parts need alone.
void add_partitions(CLI::App& program);

}  // namespace packmerger::bench
