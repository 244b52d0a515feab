#include "agents/report/report.h"

#include <iostream>

#include "agents/report/html_page.h"
#include "base/error.h"
#include "base/files.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"

namespace gusset {
namespace {

class ReportCommand final : public Command {
 public:
  const char* name() const override { return "report"; }
  const char* summary() const override {
    return "One page, for a browser without a network, of what runs and experiments came to";
  }

  void Declare(CLI::App& app) override {
    app.add_option("folders", folders_, "Run folders, folders of experiment and of play")
        ->required()
        ->type_name("DIR");
    app.add_option("--out", out_, "The page to write")->required()->type_name("FILE.html");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    // A slip of the hand would put the page in the place of what it shows.
    std::error_code none;
    const std::string suffix =
        CLI::detail::to_lower(std::filesystem::path(out_).extension().string());
    if (std::filesystem::is_regular_file(out_, none) && suffix != ".html" && suffix != ".htm") {
      throw InputError("--out: " + out_ + " is there already and does not end in .html");
    }
    CheckWritable(out_);
    // A report depends on no setting; mistakes in those given are told all the same.
    if (!common_.config_files.empty() || !common_.assignments.empty()) LoadSettings(common_, {});
    const Published published = Published::Load(AssetsFolder() / "published" / "thesis.toml");
    const std::string page =
        FillPage("report", CollectReport({folders_.begin(), folders_.end()}, published));
    WriteFileAtomic(out_, page);
    std::cout << out_ << ": " << (page.size() + 1023) / 1024 << " KiB" << std::endl;
  }

 private:
  CommonOptions common_;
  std::vector<std::string> folders_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Command> MakeReportCommand() { return std::make_unique<ReportCommand>(); }

}  // namespace gusset
