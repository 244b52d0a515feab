#include "base/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Cloth {
  double friction = 0.4;
  int nodes = 500;
  bool sewn = true;
  std::string fabric = "cotton";
  std::vector<double> size_m = {0.3, 0.35};

  template <class V>
  void Fields(V& v) {
    v("friction", friction, {0.2, 0.8});
    v("nodes", nodes, {100, 5000});
    v("sewn", sewn);
    v("fabric", fabric, {"cotton", "film"});
    v("size_m", size_m, {0.01, 1});
  }
};

Cloth ReadCloth(const std::string& text) {
  ConfigTree tree;
  tree.Parse(text, "bag1.toml");
  Cloth cloth;
  tree.Read("cloth", cloth);
  tree.RefuseUnknown();
  return cloth;
}

std::string ErrorOf(const std::string& text) {
  try {
    (void)ReadCloth(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Config, ReadsEveryKindOfField) {
  const Cloth cloth = ReadCloth(
      "[cloth]\nfriction = 0.5\nnodes = 600\nsewn = false\nfabric = \"film\"\nsize_m = [1, 0.5]\n");
  EXPECT_EQ(cloth.friction, 0.5);
  EXPECT_EQ(cloth.nodes, 600);
  EXPECT_FALSE(cloth.sewn);
  EXPECT_EQ(cloth.fabric, "film");
  EXPECT_THAT(cloth.size_m, testing::ElementsAre(1.0, 0.5));
}

TEST(Config, AbsentFieldsKeepTheirDefaults) {
  EXPECT_EQ(ReadCloth("").friction, 0.4);
  EXPECT_EQ(ReadCloth("[cloth]").nodes, 500);
}

TEST(Config, AWholeNumberServesAsANumberButNotTheOtherWayRound) {
  EXPECT_EQ(ReadCloth("cloth.size_m = [1, 1]").size_m[0], 1.0);
  EXPECT_EQ(ErrorOf("cloth.nodes = 500.0"),
            "bag1.toml:1: cloth.nodes = 500 must be a whole number");
}

TEST(Config, AValueOutOfBoundsIsNamedWithFileLineKeyValueAndBound) {
  EXPECT_EQ(ErrorOf("\n[cloth]\nfriction = 3\n"),
            "bag1.toml:3: cloth.friction = 3 is not within [0.2, 0.8]");
  EXPECT_EQ(ErrorOf("[cloth]\nsize_m = [0.3, 7]"),
            "bag1.toml:2: cloth.size_m[1] = 7 is not within [0.01, 1]");
  EXPECT_EQ(ErrorOf("[cloth]\nnodes = 99999999999"),
            "bag1.toml:2: cloth.nodes = 99999999999 is not within [100, 5000]");
  EXPECT_EQ(ErrorOf("[cloth]\nfabric = \"wool\""),
            "bag1.toml:2: cloth.fabric = \"wool\" is not one of \"cotton\", \"film\"");
}

TEST(Config, NanAndInfinityAreRefused) {
  EXPECT_EQ(ErrorOf("cloth.friction = nan"),
            "bag1.toml:1: cloth.friction = nan is not within [0.2, 0.8]");
  EXPECT_EQ(ErrorOf("cloth.friction = -inf"),
            "bag1.toml:1: cloth.friction = -inf is not within [0.2, 0.8]");
  EXPECT_EQ(ErrorOf("cloth.size_m = [0.3, nan]"),
            "bag1.toml:1: cloth.size_m[1] = nan is not within [0.01, 1]");
}

TEST(Config, AWrongTypeIsRefused) {
  EXPECT_EQ(ErrorOf("cloth.friction = \"high\""),
            "bag1.toml:1: cloth.friction = \"high\" must be a number");
  EXPECT_EQ(ErrorOf("cloth.sewn = 1"), "bag1.toml:1: cloth.sewn = 1 must be true or false");
  EXPECT_EQ(ErrorOf("cloth.fabric = 1"), "bag1.toml:1: cloth.fabric = 1 must be a text in quotes");
  EXPECT_EQ(ErrorOf("cloth.size_m = [0.3]"),
            "bag1.toml:1: cloth.size_m = a list of numbers must have 2 numbers, not 1");
  EXPECT_THAT(ErrorOf("cloth.size_m = [\"a\"]"), HasSubstr("must be a list of 2 numbers"));
  EXPECT_EQ(ErrorOf("cloth = 3"), "bag1.toml:1: cloth is a table, not a value");
  EXPECT_EQ(ErrorOf("[cloth.friction]"), "bag1.toml:1: cloth.friction is a value, not a table");
}

TEST(Config, AnUnknownKeyIsNamedWithTheNearestKnownOne) {
  EXPECT_EQ(ErrorOf("[cloth]\nfricton = 0.3"),
            "bag1.toml:2: unknown key cloth.fricton; did you mean cloth.friction?");
  EXPECT_EQ(ErrorOf("[cloth]\nxyzzyxyzzy = 0.3"), "bag1.toml:2: unknown key cloth.xyzzyxyzzy");
  EXPECT_EQ(ErrorOf("[clothes]"), "bag1.toml:1: unknown table clothes");
}

TEST(Config, ASyntaxErrorNamesFileAndLineOnOneLine) {
  for (const char* text : {"[cloth]\nfriction = \n", "[\f0H[", "a = 1\na = 2", "\xff\xfe", "x"}) {
    const std::string error = ErrorOf(text);
    EXPECT_THAT(error, testing::StartsWith("bag1.toml:")) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(Config, ForgetsWhatAFileGaveAndNothingElse) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "cloth.toml";
  WriteFileAtomic(file, "[cloth]\nfriction = 0.3\nnodes = 300\nsize_m = [0.3, 0.4]\n");
  ConfigTree tree;
  tree.Parse("[cloth]\nfriction = 0.30\nnodes = 200\nsize_m = [0.3, 0.4]\nfabric = 'film'",
             "run.toml");
  tree.Forget(file);
  Cloth cloth;
  tree.Read("cloth", cloth);
  EXPECT_EQ(cloth.friction, Cloth().friction);
  EXPECT_EQ(cloth.nodes, 200) << "set since";
  EXPECT_EQ(cloth.size_m, Cloth().size_m);
  EXPECT_EQ(cloth.fabric, "film") << "not in that file";
  EXPECT_THROW(tree.Forget("/nowhere.toml"), InputError);
}

TEST(Config, LaterFilesAndSetWinAndSayWhereTheyCameFrom) {
  ConfigTree tree;
  tree.Parse("[cloth]\nfriction = 0.3\nnodes = 200", "a.toml");
  tree.Parse("[cloth]\nfriction = 0.6", "b.toml");
  tree.Set("cloth.fabric=film");
  tree.Set("cloth.size_m=[0.1, 0.2]");
  tree.Set(" cloth.nodes = 300 ");
  Cloth cloth;
  tree.Read("cloth", cloth);
  EXPECT_EQ(cloth.friction, 0.6);
  EXPECT_EQ(cloth.fabric, "film");
  EXPECT_EQ(cloth.nodes, 300);
  EXPECT_EQ(cloth.size_m[1], 0.2);
  tree.Set("cloth.friction=3");
  try {
    tree.Read("cloth", cloth);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "--set: cloth.friction = 3 is not within [0.2, 0.8]");
  }
}

TEST(Config, AValueThatDoesNotGoWithAnotherIsRefusedWithItsPlace) {
  ConfigTree tree;
  tree.Parse("[cloth]\n\nfriction = 0.3", "a.toml");
  const auto refusal = [&](const char* key, double value) -> std::string {
    try {
      tree.Refuse(key, value, "is too much");
    } catch (const InputError& e) {
      return e.what();
    }
  };
  EXPECT_EQ(refusal("cloth.friction", 0.3), "a.toml:3: cloth.friction = 0.3 is too much");
  EXPECT_EQ(refusal("cloth.nodes", 500), "cloth.nodes = 500 is too much") << "a default";
  tree.Set("cloth.friction=0.4");
  EXPECT_EQ(refusal("cloth.friction", 0.4), "--set: cloth.friction = 0.4 is too much");
}

// toml++ recurses into each part of a key.
TEST(Config, ALineOfAHundredThousandPartsIsRefusedAtItsPlace) {
  std::string key = "a";
  for (int i = 0; i < 100000; ++i) key += ".a";
  ConfigTree tree;
  try {
    tree.Parse("b = 1\n" + key + " = 1\n", "deep.toml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.what(), std::string("deep.toml:2: is longer than 10000 bytes"));
  }
  EXPECT_THROW(tree.Set(key + "=1"), InputError);
}

TEST(Config, ATextIsTakenAsItIs) {
  ConfigTree tree;
  struct {
    std::string bag;
    void Fields(ConfigVisitor& v) { v("bag", bag, {}); }
  } train;
  const std::string text = "my \"bag\" = [1]\n.toml";
  tree.SetText("train.bag", text, "--bag");
  tree.Read("train", train);
  EXPECT_EQ(train.bag, text);
  EXPECT_THROW(tree.SetText("train.bag", "\xff.toml", "--bag"), InputError) << "no UTF-8";
}

TEST(Config, AMalformedSetIsRefusedInOneLine) {
  for (const char* bad : {"", "=", "cloth.friction", "=3", ".a=3", "a..b=3", "a b=3",
                          "cloth.fabric=two words", "a=1\nb=2", "a=[1"}) {
    ConfigTree tree;
    try {
      tree.Set(bad);
      ADD_FAILURE() << bad;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::StartsWith("--set: "));
      EXPECT_THAT(e.what(), testing::Not(HasSubstr("\n")));
    }
  }
}

TEST(Config, ANestedSectionMakesItsParentsKnown) {
  ConfigTree tree;
  tree.Parse("[sim.cloth]\nfriction = 0.3", "a.toml");
  EXPECT_TRUE(tree.Has("sim"));
  EXPECT_TRUE(tree.Has("sim.cloth"));
  EXPECT_TRUE(tree.Has("sim.cloth.friction"));
  EXPECT_FALSE(tree.Has("sim.clo"));
  Cloth cloth;
  tree.Read("sim.cloth", cloth);
  EXPECT_EQ(cloth.friction, 0.3);
  EXPECT_NO_THROW(tree.RefuseUnknown());
}

TEST(Config, ACopyIsIndependent) {
  ConfigTree tree;
  tree.Parse("cloth.friction = 0.3", "a.toml");
  ConfigTree copy = tree;
  copy.Set("cloth.friction=0.7");
  Cloth cloth;
  tree.Read("cloth", cloth);
  EXPECT_EQ(cloth.friction, 0.3);
  copy.Read("cloth", cloth);
  EXPECT_EQ(cloth.friction, 0.7);
}

TEST(Config, WhatIsWrittenReadsBackToTheSameBits) {
  Cloth cloth;
  cloth.friction = 0.1 + 0.2;  // no short decimal
  cloth.fabric = "film";
  cloth.size_m = {1.0 / 3.0, 1};
  cloth.sewn = false;
  std::string text;
  AppendToml("cloth", cloth, text);
  const Cloth back = ReadCloth(text);
  EXPECT_EQ(back.friction, cloth.friction);
  EXPECT_EQ(back.fabric, cloth.fabric);
  EXPECT_EQ(back.size_m, cloth.size_m);
  EXPECT_EQ(back.sewn, cloth.sewn);
}

struct Name {
  std::string text;
  template <class V>
  void Fields(V& v) {
    v("text", text, {});
  }
};

TEST(Config, AnyTextSurvivesWriting) {
  const Name name{"quote \" backslash \\ newline \n tab \t bell \a umlaut \xc3\xa4"};
  std::string out;
  AppendToml("name", name, out);
  ConfigTree tree;
  tree.Parse(out, "t");
  Name back;
  tree.Read("name", back);
  EXPECT_EQ(back.text, name.text);
}

TEST(Config, ValidateNamesTheFieldWithoutAFile) {
  Cloth cloth;
  cloth.friction = std::numeric_limits<double>::quiet_NaN();
  try {
    ValidateOrThrow("cloth", cloth);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "cloth.friction = nan is not within [0.2, 0.8]");
  }
  EXPECT_NO_THROW(ValidateOrThrow("cloth", Cloth{}));
}

TEST(Config, AFileThatCannotBeReadIsNamed) {
  ConfigTree tree;
  EXPECT_THROW(tree.Load("/nowhere/bag.toml"), InputError);
  EXPECT_THROW(tree.Load("/tmp"), InputError);
}

TEST(Config, AnAssetsFolderThatIsNoneIsRefused) {
  ::setenv("GUSSET_ASSETS", "/nowhere", 1);
  EXPECT_THROW((void)AssetsFolder(), InputError);
  ::unsetenv("GUSSET_ASSETS");
  EXPECT_TRUE(std::filesystem::is_directory(AssetsFolder()));
}

}  // namespace
}  // namespace gusset
