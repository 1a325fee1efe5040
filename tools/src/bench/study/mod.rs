//! The studies of photon mapping's parameters, placeholder of the next commit.
