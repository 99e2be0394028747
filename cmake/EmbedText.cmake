# cmake -DFILES=a;b;… -DOUT=….cpp -P EmbedText.cmake
# Writes a C++ source with `review_asset(name)`, which returns the text of each file by its name.
set(entries "")
foreach(file ${FILES})
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" text)
  string(APPEND entries "  if (name == \"${name}\") return R\"ASSET~(${text})ASSET~\";\n")
endforeach()
file(WRITE "${OUT}.part" "#include \"apps/review_assets.h\"\n\nnamespace vultus::apps {\n\n\
std::string_view review_asset(std::string_view name) {\n${entries}  return {};\n}\n\n}  // namespace vultus::apps\n")
file(RENAME "${OUT}.part" "${OUT}")
