// Byte ranges and problem documents, by RFC 9110 and RFC 9457.
#include "server/http/message.h"

#include <gtest/gtest.h>

#include "server/error_table.h"

namespace standin {
namespace {

struct Answered {
  int status;
  std::uint64_t begin, bytes;
};

Answered ask(const std::string& range, const std::string& if_range = "", const std::string& if_none_match = "") {
  HttpRequest request;
  if (!range.empty()) request.headers["range"] = range;
  if (!if_range.empty()) request.headers["if-range"] = if_range;
  if (!if_none_match.empty()) request.headers["if-none-match"] = if_none_match;
  const HttpResponse response = file_response(request, "file", 100, "abc", "text/plain");
  const auto* file = std::get_if<FileBody>(&response.body);
  return {response.status, file == nullptr ? 0 : file->begin, file == nullptr ? 0 : file->bytes};
}

void expect(const Answered& got, int status, std::uint64_t begin, std::uint64_t bytes) {
  EXPECT_EQ(got.status, status);
  EXPECT_EQ(got.begin, begin);
  EXPECT_EQ(got.bytes, bytes);
}

TEST(FileResponse, TakesOneRange) {
  expect(ask(""), 200, 0, 100);
  expect(ask("bytes=0-0"), 206, 0, 1);
  expect(ask("bytes=10-19"), 206, 10, 10);
  expect(ask("bytes=90-"), 206, 90, 10);
  expect(ask("bytes=90-1000"), 206, 90, 10);
  expect(ask("bytes=-30"), 206, 70, 30);
  expect(ask("bytes=-300"), 206, 0, 100);
}

TEST(FileResponse, SendsTheWholeWhereARangeIsNone) {
  for (const char* range : {"bytes=9-2", "bytes=a-b", "bytes=", "bytes=-", "lines=1-2", "bytes=0-1,5-6", "bytes=99999999999999999999-",
                            "bytes=0x1-2", "bytes= 1-2"})
    expect(ask(range), 200, 0, 100);
}

TEST(FileResponse, RefusesWhatLiesBeyondTheEnd) {
  for (const char* range : {"bytes=100-", "bytes=100-200", "bytes=-0", "bytes=18446744073709551615-"})
    EXPECT_THROW((void)ask(range), Failure) << range;
  expect(ask("bytes=0-18446744073709551615"), 206, 0, 100);
}

TEST(FileResponse, KnowsItsEtag) {
  expect(ask("bytes=0-9", "\"abc\""), 206, 0, 10);
  expect(ask("bytes=0-9", "\"old\""), 200, 0, 100);
  EXPECT_EQ(ask("", "", "\"abc\"").status, 304);
  EXPECT_EQ(ask("", "", "\"x\", \"abc\"").status, 304);
  EXPECT_EQ(ask("", "", "\"x\"").status, 200);
}

TEST(Problems, CarryTheTablesWordAndStatus) {
  for (int i = 0; i <= static_cast<int>(ErrorWord::kInternal); ++i) {
    const auto word = static_cast<ErrorWord>(i);
    const HttpResponse response = problem_response(Failure(word, "why"));
    const auto document = nlohmann::json::parse(std::get<std::string>(response.body));
    EXPECT_EQ(response.status, error_row(word).http_status);
    EXPECT_EQ(document["status"], response.status);
    EXPECT_EQ(word_named(document["word"].get<std::string>()), word);
    EXPECT_EQ(document["detail"], "why");
    EXPECT_EQ(document["title"] == "Internal Server Error", response.status == 500) << response.status;
  }
}

TEST(Problems, NameWrongFields) {
  const HttpResponse response = problem_response(InvalidBody(std::vector<FieldProblem>{{"/a", "x"}, {"/b", "y"}}));
  const auto document = nlohmann::json::parse(std::get<std::string>(response.body));
  EXPECT_EQ(response.status, 422);
  EXPECT_EQ(document["errors"][1]["pointer"], "/b");
}

TEST(TextBody, IsBounded) {
  TextBody body(4);
  body.write("abc");
  body.write("d");
  EXPECT_THROW(body.write("e"), Failure);
  EXPECT_EQ(body.text(), "abcd");
}

}  // namespace
}  // namespace standin
