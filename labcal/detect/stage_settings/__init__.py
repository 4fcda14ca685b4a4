"""The settings of each stage of detection, one file a stage; `labcal.detect.settings` composes them."""
