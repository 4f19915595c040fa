import { afterAll, afterEach } from 'vitest';
import { destroyDevices, throwDeviceErrors } from './device-errors.ts';

// Set up for each file of tests, also where several share a process and its modules. It imports
// nothing of core: a test could not replace a module that was imported before it.
afterEach(throwDeviceErrors);
afterAll(destroyDevices);
