/** Devices whose errors fail the running test. */
const watched = new Map<GPUDevice, string[]>();
const closing = new WeakSet<GPUDevice>();

/** Fails the running test on any error or loss of `device`. */
export function watchDevice(device: GPUDevice): void {
  const errors: string[] = [];
  watched.set(device, errors);
  device.addEventListener('uncapturederror', (event) => {
    event.preventDefault();
    errors.push(`${event.error.constructor.name}: ${event.error.message}`);
  });
  const destroy = device.destroy.bind(device);
  device.destroy = () => {
    closing.add(device);
    return destroy();
  };
  void device.lost.then((info) => {
    if (!closing.has(device)) errors.push(`device lost (${info.reason}): ${info.message}`);
  });
}

/** Throws the errors of the running test's devices, and forgets them. */
export async function throwDeviceErrors(): Promise<void> {
  const errors: string[] = [];
  for (const [device, found] of watched) {
    if (!closing.has(device))
      // Errors are reported before submitted work is done; a lost device reports nothing more.
      await Promise.race([device.queue.onSubmittedWorkDone(), device.lost]).catch(() => {});
    errors.push(...found.splice(0));
    if (closing.has(device)) watched.delete(device);
  }
  if (errors.length > 0) throw new Error(`GPU errors during this test:\n${errors.join('\n')}`);
}

/** Destroys the devices that a file's tests have left, and returns shared ones. */
export function destroyDevices(): void {
  for (const device of watched.keys()) if (!closing.has(device)) device.destroy();
}
