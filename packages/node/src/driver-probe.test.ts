import { expect, test } from 'vitest';
import { realSurroundings } from './installed-drivers.ts';
import { opensAdapter } from './node-gpu.ts';
import { vulkanRoutes } from './vulkan-routes.ts';

const software = vulkanRoutes(realSurroundings(), true).find(({ mayFail }) => !mayFail);

test.skipIf(!software)(
  'a driver that works opens, also by Chromium’s loader, and one that does not exist does not',
  async () => {
    const { loaders, driverFiles } = software!;
    const opens = (loader: string, driver: string) =>
      opensAdapter(
        loader,
        { VK_DRIVER_FILES: driver, VK_ICD_FILENAMES: driver },
        { forceFallbackAdapter: true },
      );
    // The last is beside the driver, outside the library path, or else the system's.
    expect(await opens(loaders.at(-1)!, driverFiles![0])).toBe(true);
    expect(await opens(loaders[0], '/none.json')).toBe(false);
  },
);
