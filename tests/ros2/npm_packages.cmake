# Installs the npm packages of this folder into OUT, once: the versions and checksums of package-lock.json, from the
# registry that npm is set up for. Succeeds without them, saying why: tests that need them then skip themselves.
# Usage: cmake -DIN=... -DOUT=... -P npm_packages.cmake
file(MAKE_DIRECTORY "${OUT}")
file(GLOB scripts RELATIVE "${IN}" "${IN}/*.mjs")
foreach(file IN ITEMS package.json package-lock.json ${scripts})
  configure_file("${IN}/${file}" "${OUT}/${file}" COPYONLY)
endforeach()
file(READ "${OUT}/package-lock.json" lock)
if(lock MATCHES "\"resolved\"")
  message(FATAL_ERROR "package-lock.json says where packages were downloaded from; remove its `resolved` fields, so that "
                      "it holds everywhere (npm install --package-lock-only --omit-lockfile-registry-resolved)")
endif()
file(SHA256 "${OUT}/package-lock.json" wanted)
if(EXISTS "${OUT}/installed")
  file(READ "${OUT}/installed" installed)
  if(installed STREQUAL wanted)
    return()
  endif()
endif()
file(REMOVE "${OUT}/installed")
find_program(NPM npm)
find_program(NODE NAMES node nodejs)
if(NOT NPM OR NOT NODE)
  message(NOTICE "npm or node is not installed; the tests with decoders that are not ours will be skipped")
  return()
endif()
execute_process(COMMAND "${NPM}" ci --no-audit --no-fund --ignore-scripts
                        --fetch-retries 1 --fetch-retry-mintimeout 1000 --fetch-retry-maxtimeout 2000
                WORKING_DIRECTORY "${OUT}"
                RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output TIMEOUT 120)
if(NOT status EQUAL 0)
  message(NOTICE "npm could not install the packages; the tests with decoders that are not ours will be skipped:\n${output}")
  return()
endif()
file(WRITE "${OUT}/installed" "${wanted}")
