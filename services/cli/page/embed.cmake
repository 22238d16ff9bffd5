# Writes the style and script of the evaluation's page into a C++ file: OUTPUT, from STYLES and SCRIPTS. The scripts are
# modules that import only from each other and in this order, so that joining them needs no bundler.
set(style "")
set(script "")
foreach(file ${STYLES})
  file(READ ${file} content)
  string(APPEND style "${content}")
endforeach()
foreach(file ${SCRIPTS})
  file(READ ${file} content)
  string(REGEX REPLACE "(^|\n)import [^\n]*" "\\1" content "${content}")
  string(REGEX REPLACE "(^|\n)export " "\\1" content "${content}")
  string(APPEND script "${content}")
endforeach()
file(WRITE ${OUTPUT} "#include \"services/cli/report/page_assets.h\"\n\nnamespace thalweg::cli {\n"
  "const std::string_view kEvaluationStyle = R\"asset(${style})asset\";\n"
  "const std::string_view kEvaluationScript = R\"asset(${script})asset\";\n}  // namespace thalweg::cli\n")
