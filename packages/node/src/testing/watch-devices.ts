import { afterEach } from 'vitest';
import { throwDeviceErrors } from '../gpu-test.ts';

// Set up for each file of tests, also where several share a process and with it the modules that they import.
afterEach(throwDeviceErrors);
