// Exports what a plug-in of another program would.

extern "C" {
extern const char csx600_firmware[64];
const char csx600_firmware[64] = "0.0.1-000000000000";
}
