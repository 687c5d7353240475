// The tables of the daemon's settings that concern no printer. For config.cpp only.
#pragma once

#include "daemon/settings/config.h"
#include "daemon/settings/config_table.h"

namespace packmerger {

// A path of the settings: taken from the folder of their file.
std::filesystem::path resolved(const std::filesystem::path& file, const std::string& text);

void read_prepare(TableReader& reader, const std::filesystem::path& file, PrepareConfig& prepare);
void read_watch(TableReader& reader, WatchConfig& watch);
void read_web(TableReader& reader, const std::filesystem::path& file, WebConfig& web);
void read_webhook(TableReader& reader, WebhookSettings& webhook);
void read_mqtt(TableReader& reader, const std::filesystem::path& file, MqttSettings& mqtt);

}  // namespace packmerger
