# Bundles the page, and the report of a run, in the build tree. A failure, such as a registry that cannot be reached,
# costs only these: it is reported, and the build goes on.
file(MAKE_DIRECTORY ${WORK})
file(COPY ${SOURCE}/ DESTINATION ${WORK} PATTERN node_modules EXCLUDE)
file(COPY ${REPORT}/ DESTINATION ${WORK}/report)
file(REMOVE_RECURSE ${OUTPUT})
file(REMOVE ${REPORT_OUTPUT}/report.html)
execute_process(COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error --ignore-scripts
  WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT failed)
  execute_process(COMMAND ${NPM} run --silent build -- --outdir=${OUTPUT} --registry=${REGISTRY} --reportdir=${REPORT_OUTPUT}
    WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
endif()
if(failed)
  file(REMOVE_RECURSE ${OUTPUT})
  file(REMOVE ${REPORT_OUTPUT}/report.html)
  message(WARNING "The gateway's page and the template of report.html were not built; everything else was. npm says:\n${said}")
endif()
