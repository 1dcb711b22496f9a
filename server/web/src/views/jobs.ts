import type { View } from "../main"; export const showJobs: View = async (host) => { host.append("jobs"); };
