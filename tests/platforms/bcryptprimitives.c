/* Where Rust's library takes its random numbers from on Windows. An old Wine (8.0, that of Debian 12) does not have it; beside the
 * host that loads the FMU's library this one stands in for it.
 */
#include <windows.h>

/* RtlGenRandom, as the system has it under its number. */
BOOLEAN NTAPI SystemFunction036(PVOID data, ULONG size);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T size) { return SystemFunction036(data, (ULONG)size); }
