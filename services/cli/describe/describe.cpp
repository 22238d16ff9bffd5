#include "services/cli/describe/describe.h"

#include <cctype>
#include <sstream>
#include <vector>

namespace thalweg::cli {
namespace {

std::vector<const CLI::App*> CommandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

bool TakesValue(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// The option's names as typed, "--out", "-h", each preceded by a space.
std::string NamesOf(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += " -" + name;
  for (const std::string& name : option.get_lnames()) names += " --" + name;
  return names;
}

std::string OptionsOf(const CLI::App& app, bool only_with_value) {
  std::string names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->nonpositional() && (TakesValue(*option) || !only_with_value)) names += NamesOf(*option);
  }
  return names;
}

bool TakesScenario(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() && option->get_name(true) == "scenario") return true;
  }
  return false;
}

/// Escapes text for troff, so that no character has a special meaning.
std::string Plain(const std::string& text) {
  std::string plain;
  bool line_starts = true;
  for (const char c : text) {
    if (line_starts && (c == '.' || c == '\'')) plain += "\\&";
    if (c == '\\') {
      plain += "\\e";
    } else if (c == '-') {
      plain += "\\-";
    } else {
      plain += c;
    }
    line_starts = c == '\n';
  }
  return plain;
}

/// "TEXT" of "TEXT:FILE", as CLI11 names the type of an option whose value is validated.
std::string TypeOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

void WriteOptions(const CLI::App& app, std::ostream& page) {
  for (const CLI::Option* option : app.get_options()) {
    page << ".TP\n";
    if (option->nonpositional()) {
      std::string separator;
      std::istringstream names(NamesOf(*option));
      for (std::string name; names >> name; separator = ", ")
        page << separator << "\\fB" << Plain(name) << "\\fR";
      if (TakesValue(*option)) page << " \\fI" << Plain(TypeOf(*option)) << "\\fR";
    } else {
      page << "\\fI" << Plain(option->get_name(true)) << "\\fR";
    }
    page << '\n' << Plain(option->get_description());
    if (!option->get_default_str().empty()) page << " [" << Plain(option->get_default_str()) << ']';
    page << '\n';
  }
}

/// One for each command that has none below it.
void WriteSynopses(const CLI::App& app, const std::string& path, std::ostream& page) {
  for (const CLI::App* command : CommandsOf(app)) {
    const std::string its_path = path + ' ' + command->get_name();
    if (!CommandsOf(*command).empty()) {
      WriteSynopses(*command, its_path, page);
      continue;
    }
    page << ".B " << its_path << "\n[\\fIoptions\\fR]";
    for (const CLI::Option* option : command->get_options()) {
      if (!option->get_positional()) continue;
      const std::string argument = "\\fI" + Plain(option->get_name(true)) + "\\fR";
      page << ' ' << (option->get_required() ? argument : "[" + argument + "]");
    }
    page << "\n.br\n";
  }
}

void WriteCommands(const CLI::App& app, const std::string& path, std::ostream& page) {
  for (const CLI::App* command : CommandsOf(app)) {
    const std::string its_path = path + ' ' + command->get_name();
    page << ".SS " << its_path << '\n' << Plain(command->get_description()) << '\n';
    WriteOptions(*command, page);
    if (!command->get_footer().empty()) page << ".PP\n" << Plain(command->get_footer()) << '\n';
    WriteCommands(*command, its_path, page);
  }
}

/// Writes what is completed behind a command, and behind those below it: cases of the script's `case`.
void WriteCases(const CLI::App& app, const std::string& path, std::ostream& script) {
  for (const CLI::App* command : CommandsOf(app)) {
    const std::string its_path = path + ' ' + command->get_name();
    script << "        '" << its_path << "') commands='";
    for (const CLI::App* below : CommandsOf(*command)) script << ' ' << below->get_name();
    script << "' options='" << OptionsOf(*command, false) << "' values='" << OptionsOf(*command, true)
           << "' scenarios=" << (TakesScenario(*command) ? "yes" : "") << " ;;\n";
    WriteCases(*command, its_path, script);
  }
}

}  // namespace

std::string BashCompletion(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string commands;
  for (const CLI::App* command : CommandsOf(app)) commands += " " + command->get_name();
  std::ostringstream script;
  script
      << "# Completion of " << name << " for bash, printed by: " << name << " completion\n_" << name
      << "() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command= scenarios= i\n"
         "  local options='"
      << OptionsOf(app, false) << "' values='" << OptionsOf(app, true) << "' commands='" << commands
      << "'\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    if [[ \" $commands \" == *\" ${COMP_WORDS[i]} \"* ]]; then\n"
         "      command+=\" ${COMP_WORDS[i]}\"\n"
         "      case $command in\n";
  WriteCases(app, "", script);
  script << "      esac\n"
            "    fi\n"
            "  done\n"
            "  COMPREPLY=()\n"
            "  [[ \" $values \" != *\" $before \"* ]] || return 0  # a value: files\n"
            "  if [[ $word == -* ]]; then\n"
            "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
            "  elif [[ -n $commands ]]; then\n"
            "    mapfile -t COMPREPLY < <(compgen -W \"$commands\" -- \"$word\")\n"
            "  elif [[ -n $scenarios ]]; then\n"
            "    local folder=${THALWEG_SCENARIOS-} file names=\n"
            "    [[ -n $folder ]] ||\n"
            "      folder=$(dirname \"$(readlink -f \"$(type -P \"$1\")\")\")/../share/thalweg/scenarios\n"
            "    for file in \"$folder\"/*.txtpb; do file=${file##*/}; names+=\" ${file%.txtpb}\"; done\n"
            "    mapfile -t COMPREPLY < <(compgen -W \"$names\" -- \"$word\")\n"
            "  fi\n"
            "}\n"
            "complete -o default -F _"
         << name << ' ' << name << '\n';
  return script.str();
}

std::string ManualPage(const CLI::App& app, const std::string& version) {
  const std::string name = app.get_name();
  std::string title = name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::ostringstream page;
  page << ".TH " << title << " 1 \"\" \"" << name << ' ' << version << "\" \"User Commands\"\n.SH NAME\n"
       << name << " \\- " << Plain(app.get_description()) << "\n.SH SYNOPSIS\n";
  WriteSynopses(app, name, page);
  page << ".SH OPTIONS\n";
  WriteOptions(app, page);
  page << ".SH COMMANDS\n";
  WriteCommands(app, name, page);
  page << ".SH EXIT STATUS\n"
          "0 on success, 2 when the command line is not understood, 3 when an exploration succeeded but not "
          "all of "
          "its files could be written, or its mapper failed at the end, 1 on everything else that went "
          "wrong.\n";
  return page.str();
}

}  // namespace thalweg::cli
