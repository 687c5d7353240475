#include "model/profile/near_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace packmerger {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kIds = {"fuse1",      "marlin", "objet30",
                                       "replicator", "uprint", "uprint-plus"};

TEST(NearProfile, IsTheMachinesOwnKindElseTheOneForFilament) {
  for (const auto& [name, near] : {std::pair{"ender3", "marlin"},
                                   {"Prusa-MK4", "marlin"},
                                   {"Objet Connex 500", "objet30"},
                                   {"sinterit_lisa", "fuse1"},
                                   {"makerbot_2x", "replicator"},
                                   {"Dimension-SST", "uprint"},
                                   {"Stratasys J55", "objet30"},
                                   {"", "marlin"}}) {
    const std::string told = near_profile(name, kIds);
    EXPECT_THAT(told, HasSubstr("The nearest is \"" + std::string(near) + "\", for ")) << name;
    EXPECT_THAT(told, HasSubstr("--profile " + std::string(near) + " --set build_mm=X,Y,Z"));
  }
}

TEST(NearProfile, WhatWasMistypedComesFirst) {
  EXPECT_EQ(near_profile("replicater", kIds), "Did you mean \"replicator\"? ");
}

TEST(NearProfile, NamesNoneThatIsNotThere) { EXPECT_EQ(near_profile("ender3", {"our-own"}), ""); }

}  // namespace
}  // namespace packmerger
