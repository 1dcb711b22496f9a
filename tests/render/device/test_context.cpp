#include <gtest/gtest.h>

#include <cstdlib>

#include "render/base/error.h"
#include "render/device/context.h"
#include "render/device/fingerprint.h"

namespace standin {
namespace {

void expect_core_4_5(DeviceKind kind) {
  const auto context = make_context(kind, 4, 4);
  EXPECT_EQ(context->kind(), kind);
  EXPECT_TRUE(context->version().starts_with("4.")) << context->version();
  EXPECT_NE(context->version().find("Core"), std::string::npos) << context->version();
  EXPECT_FALSE(context->renderer().empty());
  EXPECT_NE(context->proc("glClipControl"), nullptr);
}

TEST(Context, OsMesaGivesACoreContext) {
  expect_core_4_5(DeviceKind::kOsMesa);
  EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "0");
}

TEST(Context, EglGivesACoreContext) {
  expect_core_4_5(DeviceKind::kEgl);
}

TEST(Context, AnEmptySizeIsBadUsage) {
  try {
    [[maybe_unused]] const auto context = make_context(DeviceKind::kOsMesa, 0, 16);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
  }
}

TEST(Fingerprint, NamesTheProcessor) {
  const std::string name = processor_name();
  EXPECT_FALSE(name.empty());
  EXPECT_EQ(name.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace standin
