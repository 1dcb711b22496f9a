#include "server/service/tokens.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

class TokensTest : public test::TempFolder {
 protected:
  std::filesystem::path file(const std::string& text) {
    write_file(root_ / "tokens", text);
    return root_ / "tokens";
  }
};

TEST_F(TokensTest, ATokenIsItsOwners) {
  const Tokens tokens(file("# who\nanna " + sha256_hex("one") + "\n\nbert " + sha256_hex("two") + "  # laptop\n"));
  EXPECT_TRUE(tokens.required());
  EXPECT_EQ(tokens.owner_of("Bearer one"), "anna");
  EXPECT_EQ(tokens.owner_of("bearer two"), "bert");
  for (const char* wrong : {"", "Bearer", "Bearer ", "Bearer three", "one", "Basic one", "Bearer one "})
    EXPECT_FALSE(tokens.owner_of(wrong).has_value()) << wrong;
}

TEST_F(TokensTest, OneOwnerMayHaveSeveral) {
  EXPECT_FALSE(Tokens(file("anna " + sha256_hex("one") + "\nanna " + sha256_hex("two"))).of_several_owners());
  EXPECT_TRUE(Tokens(file("anna " + sha256_hex("one") + "\nbert " + sha256_hex("two"))).of_several_owners());
}

TEST_F(TokensTest, TheHashIsNoToken) {
  EXPECT_FALSE(Tokens(file("anna " + sha256_hex("one"))).owner_of("Bearer " + sha256_hex("one")).has_value());
}

TEST_F(TokensTest, WithoutTokensEverybodyIsTheLocalOwner) {
  EXPECT_EQ(Tokens().owner_of(""), kLocalOwner);
}

TEST_F(TokensTest, WhatIsNoTableOfTokensIsRefused) {
  for (const std::string& text : std::vector<std::string>{"", "# none\n", "anna\n", "anna secret\n", "anna " + sha256_hex("x") + " more\n"})
    EXPECT_THROW(Tokens{file(text)}, Failure) << text;
}

}  // namespace
}  // namespace standin
