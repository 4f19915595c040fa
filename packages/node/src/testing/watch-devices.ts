import { afterEach } from 'vitest';
import { throwDeviceErrors } from './device-errors.ts';

// Set up for each file of tests, also where several share a process and with it the modules that they import. It imports nothing of
// core: a test could not put another module in the place of one that is there before it.
afterEach(throwDeviceErrors);
