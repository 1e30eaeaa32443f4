#!/bin/sh
# Makes the real robots of this folder again from the URDF files of example-robot-data 6.0.0 (see README.md).
# usage: datasets/models/import.sh <site-packages>/cmeel.prefix/share/example-robot-data
set -eu
data=${1:?"usage: import.sh <folder of example-robot-data>"}
here=$(cd "$(dirname "$0")" && pwd)
silent='no licence, copyright or author statement in the file'
bsd3_text='LICENSE in the same folder: "Redistribution and use in source and binary forms, with or without modification, are permitted provided that the following conditions are met"'
apache_text='LICENSE in the same folder: "Apache License, Version 2.0"'

# robot NAME BASE FILE LICENCE HEADER README [OPTION…]
robot() {
    name=$1 base=$2 file=$3 licence=$4 header=$5 readme=$6
    shift 6
    cargo run --quiet --manifest-path "$here/../../Cargo.toml" -p featherbench-formats --example import_robot -- \
        "$data/robots/$file" "$here/$name.json" --name "$name" --base "$base" \
        --source "PyPI example-robot-data 6.0.0, share/example-robot-data/robots/$file" \
        --licence "$licence" --header "$header" --readme "$readme" "$@"
}

robot g1 floating g1_description/urdf/g1_29dof_rev_1_0.urdf BSD-3-Clause "$silent" 'README.md: "license: BSD-3-Clause"'
robot g1_with_hands floating g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf BSD-3-Clause "$silent" 'README.md: "license: BSD-3-Clause"'
robot anymal_c floating anymal_c_simple_description/urdf/anymal.urdf BSD-3-Clause '"Copyright 2020 ANYbotics, https://www.anybotics.com"' \
    "README.md: \"license: BSD-3-Clause\"; $bsd3_text, \"Copyright 2020, ANYbotics AG.\""
robot solo12 floating solo_description/robots/solo12.urdf BSD-3-Clause "$silent" 'README.md: "license: BSD-3-Clause"'
robot bolt floating bolt_description/robots/bolt.urdf BSD-3-Clause "$silent" 'README.md: "license: BSD-3-Clause"'
robot hyq floating hyq_description/robots/hyq_no_sensors.urdf Apache-2.0 "$silent" 'README.md: "license: Apache-2.0"'
robot simple_humanoid floating simple_humanoid_description/urdf/simple_humanoid.urdf BSD-2-Clause "$silent" 'README.md: "license: BSD-2-Clause"'
robot centauro floating centauro_description/urdf/centauro.urdf Apache-2.0 "$silent" 'README.md: "license: Apache-2.0"'
robot panda fixed panda_description/urdf/panda.urdf Apache-2.0 "$silent" "README.md: \"license: Apache-2.0\"; $apache_text" --independent-mimics
robot xarm7 fixed xarm_description/urdf/xarm7.urdf BSD-3-Clause "$silent" 'README.md: "license: BSD-3-Clause"'
robot so101 fixed so_arm_description/urdf/so101.urdf Apache-2.0 "$silent" 'README.md: "license: Apache-2.0"'
robot baxter fixed baxter_description/urdf/baxter.urdf BSD-3-Clause "$silent" \
    "README.md: \"license: BSD\"; $bsd3_text, \"Copyright (c) 2013-2015, Rethink Robotics\"" --independent-mimics
robot ur5 fixed ur_description/urdf/ur5_robot.urdf LicenseRef-BSD "$silent" 'README.md: "license: BSD" (variant not stated)'
robot allegro_right fixed allegro_hand_description/urdf/allegro_right_hand.urdf LicenseRef-BSD "$silent" 'README.md: "license: BSD" (variant not stated)'
robot kinova fixed kinova_description/robots/kinova.urdf LicenseRef-BSD "$silent" 'README.md: "license: BSD" (variant not stated)'
