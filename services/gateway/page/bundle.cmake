# Bundles the page in the build tree. A failure, such as a registry that cannot be reached, costs only the page:
# it is reported, and the build goes on.
file(MAKE_DIRECTORY ${WORK})
file(COPY ${SOURCE}/ DESTINATION ${WORK} PATTERN node_modules EXCLUDE)
file(REMOVE_RECURSE ${OUTPUT})
execute_process(COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error --ignore-scripts
  WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT failed)
  execute_process(COMMAND ${NPM} run --silent build -- --outdir=${OUTPUT} --registry=${REGISTRY}
    WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
endif()
if(failed)
  file(REMOVE_RECURSE ${OUTPUT})
  message(WARNING "The gateway's page was not built; everything else was. npm says:\n${said}")
endif()
