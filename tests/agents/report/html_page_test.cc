#include "agents/report/html_page.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "agents/image_file.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Base64, HasTheTestVectorsOfRfc4648) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foob"), "Zm9vYg==");
  EXPECT_EQ(Base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xef\xfe"), "/+/+");
}

class HtmlPage : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    std::filesystem::create_directory(dir_ / "report");
    ::setenv("GUSSET_ASSETS", dir_.c_str(), 1);
  }
  void TearDown() override {
    ::unsetenv("GUSSET_ASSETS");
    FolderTest::TearDown();
  }
  void Template(const std::string& text) { WriteFileAtomic(dir_ / "report" / "p.html", text); }
};

TEST_F(HtmlPage, DataCannotLeaveItsElement) {
  Template("<script id=data>{{data}}</script>");
  const std::string hostile = "</script><script>alert(1)</script><!-- {{data}} \xff";
  const std::string page = FillPage("p", {{"note", hostile}});
  const std::string data = page.substr(16, page.size() - 16 - 9);
  EXPECT_THAT(data, Not(HasSubstr("<")));
  // And comes back the same, but for the byte that is no UTF-8.
  EXPECT_EQ(nlohmann::json::parse(data)["note"],
            hostile.substr(0, hostile.size() - 1) + "\xef\xbf\xbd");
}

TEST_F(HtmlPage, FilesAreInlinedAndMissingOnesNamed) {
  WriteFileAtomic(dir_ / "report" / "a.css", "b { }");
  Template("<style>{{file a.css}}</style>{{data}}.");
  EXPECT_EQ(FillPage("p", {}), "<style>b { }</style>null.");
  Template("");
  EXPECT_THROW((void)FillPage("p", {}), InputError);
  Template("{{file none.css}}{{data}}");
  try {
    (void)FillPage("p", {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("none.css: cannot be read"));
  }
  Template("{{nonsense}}{{data}}");
  EXPECT_THROW((void)FillPage("p", {}), InputError);
  Template("{{data}}{{data");
  EXPECT_THROW((void)FillPage("p", {}), InputError);
}

TEST_F(HtmlPage, PicturesAreScaledDownAndNeverUp) {
  WriteImage(dir_ / "wide.png", cv::Mat(40, 100, CV_8UC3, cv::Scalar(0, 0, 255)));
  EXPECT_THAT(PictureUri(dir_ / "wide.png", 50),
              testing::StartsWith("data:image/jpeg;base64,/9j/"));
  EXPECT_EQ(PictureUri(dir_ / "wide.png", 100), PictureUri(dir_ / "wide.png", 1000));
  WriteFileAtomic(dir_ / "none.png", "");
  EXPECT_THROW((void)PictureUri(dir_ / "none.png", 50), InputError);
  WriteFileAtomic(dir_ / "none.png", "no picture");
  EXPECT_THROW((void)PictureUri(dir_ / "none.png", 50), InputError);
}

}  // namespace
}  // namespace gusset
