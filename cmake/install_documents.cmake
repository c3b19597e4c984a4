# Installs README, docs and what belongs to them. Links to sources, which are not installed, become plain text.
#   set(SOURCE_DIR ...) set(BINARY_DIR ...) set(DOCUMENT_DIR ...), as install.cmake does
set(sources "(core|examples|python|scenes|solver|surface|tests|tools)")
file(GLOB pages RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/README.md ${SOURCE_DIR}/CHANGELOG.md
     ${SOURCE_DIR}/CONTRIBUTING.md ${SOURCE_DIR}/docs/*.md)
foreach(page IN LISTS pages)
  file(READ ${SOURCE_DIR}/${page} text)
  string(REGEX REPLACE "\\[([^]\n]*)\\]\\((\\.\\./)?${sources}(/[^)\n]*)?\\)" "\\1" text "${text}")
  file(WRITE ${BINARY_DIR}/documents/${page} "${text}")
  get_filename_component(folder ${page} DIRECTORY)
  file(INSTALL ${BINARY_DIR}/documents/${page} DESTINATION ${DOCUMENT_DIR}/${folder})
endforeach()
file(INSTALL ${SOURCE_DIR}/LICENSE ${SOURCE_DIR}/CITATION.cff DESTINATION ${DOCUMENT_DIR})
file(INSTALL ${SOURCE_DIR}/docs/images DESTINATION ${DOCUMENT_DIR}/docs)
